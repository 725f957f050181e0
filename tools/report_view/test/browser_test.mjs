// Opens reports in a browser as a person does, from disk: node browser_test.mjs PAGE.html ... [--screenshots FOLDER]
// Ends with 77 where there is no browser, with 1 at the first promise that is not kept. Times are printed, not judged.
import { chromium } from "playwright-core";
import { existsSync, statSync, mkdirSync } from "node:fs";
import { basename, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const browserPath = [process.env.ISTHMUS_BROWSER, "/usr/bin/chromium", "/usr/bin/google-chrome"].find(p => p && existsSync(p));
if (!browserPath) {
  console.log("skipped: no chromium (apt-get install chromium)");
  process.exit(77);
}
const arguments_ = process.argv.slice(2);
const at = arguments_.indexOf("--screenshots");
const screenshots = at >= 0 ? arguments_.splice(at, 2)[1] : undefined;
if (screenshots) mkdirSync(screenshots, { recursive: true });
const fail = text => { throw new Error(text); };
const expect = (good, text) => good || fail(text);

const browser = await chromium.launch({
  executablePath: browserPath,
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
});

/// Share of the canvas that is not the most frequent colour, and how many colours there are.
const look = page => page.evaluate(() => {
  const canvas = document.querySelector("#view canvas");
  const copy = document.createElement("canvas");
  copy.width = 320;
  copy.height = 180;
  const c = copy.getContext("2d");
  c.drawImage(canvas, 0, 0, copy.width, copy.height);
  const pixels = c.getImageData(0, 0, copy.width, copy.height).data, seen = new Map();
  let sum = 0;
  for (let k = 0; k < pixels.length; k += 4) {
    const key = pixels[k] << 16 | pixels[k + 1] << 8 | pixels[k + 2];
    seen.set(key, (seen.get(key) || 0) + 1);
    sum = (sum * 31 + key) % 4294967291;
  }
  return { colours: seen.size, painted: 1 - Math.max(...seen.values()) / (pixels.length / 4), sum };
});
const frame = page => page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 50)))));

const check = async path => {
  const name = basename(path, ".html");
  const bytes = statSync(path).size;
  expect(bytes < 15e6, `${name} has ${bytes} bytes, 15 MB are allowed`);
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
  const troubles = [];
  page.on("console", m => { if (m.type() === "error") troubles.push(`console: ${m.text()}`); });
  page.on("pageerror", e => troubles.push(`error: ${e.message}`));
  page.on("request", r => { if (!/^(file|data|blob):/.test(r.url())) troubles.push(`request: ${r.url()}`); });
  const start = Date.now();
  await page.goto(pathToFileURL(resolve(path)).href, { waitUntil: "load" });
  const loaded = Date.now() - start;
  await page.waitForSelector("#view[data-ready=true]", { timeout: 60000 });
  await page.waitForFunction(() => Number(document.getElementById("view").dataset.frames) > 0, undefined, { timeout: 60000 });
  console.log(`${name}: ${(bytes / 1e6).toFixed(1)} MB, page after ${loaded} ms, 3D view after ${Date.now() - start} ms`);
  await page.locator("#view").scrollIntoViewIfNeeded();
  await frame(page);

  const first = await look(page);
  expect(first.colours > 50 && first.painted > 0.05, `${name}: the canvas is blank: ${JSON.stringify(first)}`);
  if (screenshots) await page.locator("#view").screenshot({ path: join(screenshots, `${name}_view.png`) });

  // Turned by the keyboard, it looks different; by Home as before.
  await page.locator("#view canvas").focus();
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("ArrowUp");
  await frame(page);
  expect((await look(page)).sum !== first.sum, `${name}: arrow keys do not turn the view`);
  await page.keyboard.press("Home");
  await frame(page);
  expect((await look(page)).sum === first.sum, `${name}: Home does not show the whole survey again`);
  for (const colour of ["height", "intensity", "error"]) {
    const before = (await look(page)).sum;
    await page.selectOption("[data-view=colour]", colour);
    await frame(page);
    expect((await look(page)).sum !== before, `${name}: colour by ${colour} changes nothing`);
    if (screenshots) await page.locator("#view").screenshot({ path: join(screenshots, `${name}_${colour}.png`) });
  }
  await page.selectOption("[data-view=colour]", "station");

  // A head sorts, once up and once down.
  const column = "#links th:nth-child(6)";  // overlap
  const values = () => page.$$eval("#links tbody tr", rows => rows.map(r => Number(r.cells[5].dataset.v)));
  await page.click(column);
  const up = await values();
  expect(up.every((v, k) => k === 0 || up[k - 1] <= v), `${name}: overlap is not sorted upwards`);
  await page.click(column);
  const down = await values();
  expect(down.every((v, k) => k === 0 || down[k - 1] >= v), `${name}: overlap is not sorted downwards`);

  // Bounds and words filter.
  await page.fill("#needle", "overlap<20");
  const shown = await page.$$eval("#links tbody tr:not([hidden])", rows => rows.map(r => Number(r.cells[5].dataset.v)));
  expect(shown.length > 0 && shown.length < down.length && shown.every(v => v < 0.2), `${name}: the bound on the overlap does not filter`);
  await page.fill("#needle", "");

  // A click on a link marks it in the table, the plan and the matrix, and the view shows it.
  const before = (await look(page)).sum;
  const link = await page.$eval("#links tbody tr.accepted", r => r.dataset.link);
  await page.click(`#links tr[data-link="${link}"] td:nth-child(3)`);
  await frame(page);
  const marked = await page.$$eval(`[data-link="${link}"].hot`, all => all.map(e => e.tagName.toLowerCase()));
  for (const tag of ["tr", "line", "rect"]) expect(marked.includes(tag), `${name}: the link is not marked as ${tag}: ${marked}`);
  expect((await page.$$(".station.near")).length === 2, `${name}: the ends of the link are not marked`);
  expect((await look(page)).sum !== before, `${name}: the view does not show the link`);
  if (screenshots) {
    await page.locator("#view").screenshot({ path: join(screenshots, `${name}_link.png`) });
    await page.locator("h2:has-text('Links')").scrollIntoViewIfNeeded();
    await page.screenshot({ path: join(screenshots, `${name}_tables.png`) });
  }
  await page.keyboard.press("Escape");
  expect((await page.$$(".hot")).length === 0, `${name}: Escape does not let go`);

  // A station picked in the view by a click is marked in the plan and the table.
  await page.locator("#view canvas").focus();
  await page.keyboard.press("n");
  await frame(page);
  expect((await page.$$("#scans tr.hot")).length === 1 && (await page.$$(".station.hot")).length === 1, `${name}: N selects no station`);
  await page.keyboard.press("Escape");
  const spot = await page.evaluate(() => {
    const v = window.isthmus.view, r = v.canvas.getBoundingClientRect();
    v.home();
    for (const [id, p] of v.place) {
      const q = p.clone().project(v.camera);
      if (Math.abs(q.x) < 0.9 && Math.abs(q.y) < 0.9) return { id, x: r.left + (q.x + 1) / 2 * r.width, y: r.top + (1 - q.y) / 2 * r.height };
    }
  });
  await page.locator("#view canvas").scrollIntoViewIfNeeded();
  const moved = await page.evaluate(id => {
    const v = window.isthmus.view, r = v.canvas.getBoundingClientRect(), q = v.place.get(id).clone().project(v.camera);
    return { x: r.left + (q.x + 1) / 2 * r.width, y: r.top + (1 - q.y) / 2 * r.height };
  }, spot.id);
  await page.mouse.click(moved.x, moved.y);
  expect((await page.$$(".station.hot")).length === 1, `${name}: a click on a station in the view selects nothing`);
  await page.keyboard.press("Escape");

  if (screenshots) {
    await page.evaluate(() => scrollTo(0, 0));
    await page.screenshot({ path: join(screenshots, `${name}_page.png`), fullPage: true });
    await page.emulateMedia({ colorScheme: "dark" });
    await frame(page);
    await page.screenshot({ path: join(screenshots, `${name}_dark.png`), fullPage: true });
    await page.emulateMedia({ colorScheme: "light" });
    await page.pdf({ path: join(screenshots, `${name}.pdf`), format: "A4" });
  }
  expect(troubles.length === 0, `${name}: ${troubles.join("; ")}`);
  await page.close();
};

let code = 0;
try {
  expect(arguments_.length > 0, "no page was named");
  for (const path of arguments_) await check(path);
  console.log("every promise is kept");
} catch (error) {
  console.log(`FAILED: ${error.message}`);
  code = 1;
}
await browser.close();
process.exit(code);
