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
      all("th", table).forEach(h => { h.classList.remove("up", "down"); h.removeAttribute("aria-sort"); });
      head.classList.add(up ? "up" : "down");
      head.setAttribute("aria-sort", up ? "ascending" : "descending");
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
// The filter of the links: words that a row must hold, and bounds such as "overlap<20" or "loop error>30" in the units shown.
let verdict = "all";
const needle = document.getElementById("needle");
const links = document.getElementById("links");
const heads = links ? all("th", links).map(h => ({name: h.textContent.toLowerCase(), unit: Number(h.dataset.unit || 1)})) : [];
const wanted = text => {
  const bounds = [];
  const rest = text.toLowerCase().replace(/([a-z][a-z ]*|< ?\d+ ?[cm]m)\s*([<>])\s*([\d.]+)/g, (all, name, sign, bound) => {
    const column = heads.findIndex(h => h.name === name.trim() || name.trim().endsWith(" " + h.name));
    if (column < 0) return all;
    bounds.push(row => {
      const cell = row.cells[column].dataset.v;
      return cell !== undefined && cell !== "" && (sign === "<" ? Number(cell) < bound * heads[column].unit : Number(cell) > bound * heads[column].unit);
    });
    return name.trim().slice(0, -heads[column].name.length) + " ";
  });
  const words = rest.split(/\s+/).filter(w => w !== "");
  return row => bounds.every(b => b(row)) && (words.length === 0 || (() => {
    const said = (row.textContent + " " + all("td[title]", row).map(c => c.title).join(" ")).toLowerCase();
    return words.every(w => said.includes(w));
  })());
};
const filter = () => {
  const good = wanted(needle ? needle.value : "");
  let shown = 0;
  for (const row of all("#links tbody tr")) {
    row.hidden = (verdict !== "all" && !row.classList.contains(verdict)) || !good(row);
    if (!row.hidden) ++shown;
  }
  const count = document.getElementById("shown");
  if (count) count.textContent = `${shown} shown`;
};
const press = wantedVerdict => {
  verdict = wantedVerdict;
  all("button[data-verdict]").forEach(b => b.setAttribute("aria-pressed", b.dataset.verdict === verdict));
  filter();
};
for (const button of all("button[data-verdict]")) button.addEventListener("click", () => press(button.dataset.verdict));
if (needle) needle.addEventListener("input", filter);
for (const radio of all("input[name=hue]")) radio.addEventListener("change", () => document.body.classList.toggle("hue-r", radio.value === "r" && radio.checked));
const rejects = document.getElementById("show-rejected");
if (rejects) rejects.addEventListener("change", () => document.body.classList.toggle("rejects", rejects.checked));

// One thing is selected at a time, a link or a scan; it is marked wherever it is shown.
const isthmus = window.isthmus = {selected: {}, listeners: []};
isthmus.select = (what, from) => {
  isthmus.selected = what;
  all(".hot").forEach(e => e.classList.remove("hot"));
  all(".near").forEach(e => e.classList.remove("near"));
  document.body.classList.toggle("picked", what.link !== undefined || what.scan !== undefined);
  if (what.link !== undefined) {
    all(`[data-link="${what.link}"]`).forEach(e => e.classList.add("hot"));
    for (const scan of what.link.split("-")) all(`[data-scan="${scan}"]`).forEach(e => e.classList.add("near"));
  }
  if (what.scan !== undefined) {
    all(`[data-scan="${what.scan}"]`).forEach(e => e.classList.add("hot"));
    all("[data-link]").filter(e => e.dataset.link.split("-").includes(String(what.scan))).forEach(e => e.classList.add("near"));
  }
  for (const listen of isthmus.listeners) listen(what, from);
};
const show = row => {
  if (!row) return;
  if (row.hidden) { needle.value = ""; press("all"); }
  const box = row.closest(".scroll");
  if (box) box.scrollTo({top: row.offsetTop - box.clientHeight / 2, behavior: "smooth"});
};
isthmus.show = what => show(document.getElementById(what.link !== undefined ? "link-" + what.link : "scan-" + what.scan));
const what_of = e => {
  const spot = e.target.closest && e.target.closest("[data-link], [data-scan]");
  return spot ? (spot.dataset.link !== undefined ? {link: spot.dataset.link} : {scan: spot.dataset.scan}) : undefined;
};
const pick = e => {
  const what = what_of(e);
  if (!what) return;
  const same = isthmus.selected.link === what.link && isthmus.selected.scan === what.scan;
  isthmus.select(same ? {} : what, e.target);
  if (!same && !e.target.closest("table")) isthmus.show(what);
};
document.addEventListener("click", pick);
document.addEventListener("keydown", e => {
  if (e.key === "Escape") isthmus.select({});
  if ((e.key === "Enter" || e.key === " ") && what_of(e)) { e.preventDefault(); pick(e); }
  if ((e.key === "ArrowDown" || e.key === "ArrowUp") && e.target.matches && e.target.matches("tbody tr")) {
    const rows = all("tr", e.target.parentNode).filter(r => !r.hidden);
    const next = rows[rows.indexOf(e.target) + (e.key === "ArrowDown" ? 1 : -1)];
    if (next) { e.preventDefault(); next.focus(); }
  }
});
)js";

}  // namespace isthmus::report
