#include "report/page_parts.h"

namespace isthmus::report {

const char* const kPageScript = R"js(
"use strict";
const all = (what, root = document) => Array.from(root.querySelectorAll(what));
const value = (row, column) => { const cell = row.cells[column]; return cell.dataset.v !== undefined ? cell.dataset.v : cell.textContent; };
const compare = (a, b) => {
  if (a === "" || b === "") return a === b ? 0 : a === "" ? 1 : -1;
  const x = Number(a), y = Number(b);
  return isNaN(x) || isNaN(y) ? a.localeCompare(b, undefined, {numeric: true}) : x - y;
};
for (const table of all("table.sortable")) {
  all("th", table).forEach((head, column) => {
    const sort = () => {
      const up = !head.classList.contains("up");
      all("th", table).forEach(h => h.classList.remove("up", "down"));
      head.classList.add(up ? "up" : "down");
      const rows = all("tbody tr", table).sort((a, b) => {
        const va = value(a, column), vb = value(b, column);
        return va === "" || vb === "" || up ? compare(va, vb) : compare(vb, va);
      });
      table.tBodies[0].append(...rows);
    };
    head.addEventListener("click", sort);
    head.addEventListener("keydown", e => { if (e.key === "Enter") sort(); });
  });
}
let verdict = "all";
const needle = document.getElementById("needle");
const filter = () => {
  const text = needle ? needle.value.toLowerCase() : "";
  for (const row of all("#links tbody tr"))
    row.hidden = (verdict !== "all" && !row.classList.contains(verdict)) || (text !== "" && !row.textContent.toLowerCase().includes(text) &&
      !all("td[title]", row).some(cell => cell.title.toLowerCase().includes(text)));
};
for (const button of all("button[data-verdict]")) button.addEventListener("click", () => {
  verdict = button.dataset.verdict;
  all("button[data-verdict]").forEach(b => b.setAttribute("aria-pressed", b === button));
  filter();
});
if (needle) needle.addEventListener("input", filter);
for (const radio of all("input[name=hue]")) radio.addEventListener("change", () => document.body.classList.toggle("hue-r", radio.value === "r" && radio.checked));
const rejects = document.getElementById("show-rejected");
if (rejects) rejects.addEventListener("change", () => document.body.classList.toggle("rejects", rejects.checked));
const show = row => {
  if (!row) return;
  if (row.hidden) { verdict = "all"; all("button[data-verdict]").forEach(b => b.setAttribute("aria-pressed", b.dataset.verdict === "all")); needle.value = ""; filter(); }
  all("tr.hot").forEach(r => r.classList.remove("hot"));
  row.classList.add("hot");
  row.scrollIntoView({behavior: "smooth", block: "center"});
};
for (const line of all(".plan .link")) line.addEventListener("click", () => show(document.getElementById("link-" + line.dataset.link)));
for (const spot of all(".plan .station")) spot.addEventListener("click", () => show(document.getElementById("scan-" + spot.dataset.scan)));
for (const row of all("#links tbody tr")) {
  const lines = () => all(`.plan [data-link="${row.id.slice(5)}"]`);
  row.addEventListener("mouseenter", () => lines().forEach(l => l.classList.add("hot")));
  row.addEventListener("mouseleave", () => lines().forEach(l => l.classList.remove("hot")));
}
)js";

}  // namespace isthmus::report
