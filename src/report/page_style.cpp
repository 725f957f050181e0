#include "report/page_parts.h"

namespace isthmus::report {

const char* const kPageStyle = R"css(
:root {
  color-scheme: light dark;
  --paper: #f6f4ef; --card: #ffffff; --ink: #1d2429; --quiet: #66727a; --rule: #dcd8ce; --land: #c9b27c; --sea: #e8eef0;
  --c0: #0b6e69; --c1: #3f9c86; --c2: #93b453; --c3: #e0a02f; --c4: #d1563f;
  --accepted: #0b6e69; --ambiguous: #e0a02f; --rejected: #b9bfc2; --failed: #c63d4f; --accent: #0b6e69; --pick: #b0308f; --mark: #f9e8f4; --pair-a: #d2622a; --pair-b: #2272b4;
}
@media (prefers-color-scheme: dark) {
  :root {
    --paper: #12181b; --card: #1a2226; --ink: #e6eaeb; --quiet: #93a1a8; --rule: #2d383d; --land: #b99e5e; --sea: #162024;
    --c0: #35c2b4; --c1: #6fd09a; --c2: #b9d262; --c3: #f0b64a; --c4: #f07a5f;
    --accepted: #35c2b4; --ambiguous: #f0b64a; --rejected: #4c585e; --failed: #f0697b; --accent: #35c2b4; --pick: #f27fd0; --mark: #3a2335; --pair-a: #f0935c; --pair-b: #67b1ec;
  }
}
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 15px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
main { max-width: 1360px; margin: 0 auto; padding: 28px 24px 64px; }
header { display: flex; align-items: baseline; gap: 14px; color: var(--quiet); border-bottom: 1px solid var(--rule); padding-bottom: 10px; }
header b { color: var(--ink); letter-spacing: .02em; } header span:last-child { margin-left: auto; }
h1 { font-size: 34px; line-height: 1.15; font-weight: 650; margin: 28px 0 8px; letter-spacing: -.01em; text-wrap: balance; }
h1.good::before, h1.partly::before, h1.bad::before { content: ""; display: inline-block; width: .55em; height: .55em; border-radius: 50%;
  margin-right: .4em; background: var(--accepted); vertical-align: .06em; }
h1.partly::before { background: var(--ambiguous); } h1.bad::before { background: var(--failed); }
h2 { font-size: 20px; margin: 40px 0 12px; } h3 { font-size: 15px; margin: 0 0 8px; color: var(--quiet); font-weight: 600; }
p.lead { font-size: 17px; max-width: 76ch; margin: 6px 0; } .quiet, figcaption { color: var(--quiet); font-size: 13px; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(148px, 1fr)); gap: 12px; margin: 22px 0 4px; }
.tile { background: var(--card); border: 1px solid var(--rule); border-radius: 10px; padding: 12px 16px; }
.tile b { display: block; white-space: nowrap; font-size: 22px; font-weight: 650; letter-spacing: -.01em; } .tile span { color: var(--quiet); font-size: 13px; }
.card { background: var(--card); border: 1px solid var(--rule); border-radius: 10px; padding: 16px; margin: 12px 0; }
.two { display: grid; grid-template-columns: repeat(auto-fit, minmax(420px, 1fr)); gap: 12px; } .two .card { margin: 0; }
.parts { display: grid; grid-template-columns: repeat(auto-fill, minmax(420px, 1fr)); gap: 12px; } .parts .card { margin: 0; }
svg { display: block; width: 100%; height: auto; } svg text { font: 11px system-ui, "DejaVu Sans", sans-serif; fill: var(--quiet); }
.plan { background: var(--sea); border-radius: 8px; }
.footprints circle { fill: var(--land); fill-opacity: .10; }
.link { stroke: var(--c0); stroke-linecap: round; }
.p0, .c0 { stroke: var(--c0); fill: var(--c0); } .p1, .c1 { stroke: var(--c1); fill: var(--c1); } .p2, .c2 { stroke: var(--c2); fill: var(--c2); }
.p3, .c3 { stroke: var(--c3); fill: var(--c3); } .p4, .c4 { stroke: var(--c4); fill: var(--c4); }
.hue-r .r0 { stroke: var(--c0); } .hue-r .r1 { stroke: var(--c1); } .hue-r .r2 { stroke: var(--c2); } .hue-r .r3 { stroke: var(--c3); }
.hue-r .r4 { stroke: var(--c4); }
.link.accepted { stroke-opacity: .85; } .link.ambiguous { stroke-dasharray: 7 6; stroke-opacity: .8; }
.link.bridge { stroke-dasharray: 14 3 2 3; stroke-linecap: butt; }
.link.rejected, .hue-r .link.rejected { stroke: var(--rejected); stroke-dasharray: 1 5; display: none; } .rejects .link.rejected { display: inline; }
.plan .link, .matrix [data-link], .matrix [data-scan] { cursor: pointer; }
.plan .link:hover, .plan .link.hot { stroke: var(--pick) !important; stroke-opacity: 1; display: inline; }
.plan .link.hot { stroke-width: 9px; } .plan .link.rejected.near, .plan .link.ambiguous.near { display: inline; }
.picked .plan .link:not(.hot):not(.near) { stroke-opacity: .22; }
.station.hot .dot, .station.near .dot { fill: var(--pick); stroke: var(--pick); } .station.hot .dot { stroke-width: 7; }
.station:focus-visible { outline: none; } .station:focus-visible .dot { stroke: var(--pick); stroke-width: 5; }
.matrix rect.hot, .matrix rect.diagonal.near { stroke: var(--pick); stroke-width: 3; } .matrix rect.diagonal.near, .matrix rect.diagonal.hot { fill: var(--pick); }
.matrix rect.near { stroke: var(--pick); stroke-width: 1.2; }
.station .dot { fill: var(--card); stroke: var(--ink); stroke-width: 2; } .station.anchor .dot { fill: var(--ink); }
.station .ring { fill: none; stroke: var(--ink); stroke-width: 1.2; } .station { cursor: pointer; }
.station:hover .dot { fill: var(--accent); } .plan .label { pointer-events: none; fill: var(--ink); font-size: 12px; paint-order: stroke; stroke: var(--sea);
  stroke-width: 3px; stroke-linejoin: round; } .plan .many .label { font-size: 9.5px; }
#view canvas { display: block; width: 100%; height: 600px; border-radius: 8px; background: var(--sea); cursor: grab; touch-action: none; }
#view.off canvas, #view.off .view-bar { display: none; } .view-bar { display: flex; flex-wrap: wrap; gap: 8px 18px; align-items: center; margin-bottom: 12px;
  font-size: 13px; color: var(--quiet); } .view-bar select, .view-bar button { font: inherit; color: var(--ink); background: var(--card);
  border: 1px solid var(--rule); border-radius: 99px; padding: 3px 12px; cursor: pointer; } .view-bar button:first-of-type { margin-left: auto; }
.view-bar input[type=range] { width: 110px; vertical-align: middle; accent-color: var(--accent); } .view-legend { margin: 10px 0 0; min-height: 1.6em; }
.view-legend i { display: inline-block; width: 12px; height: 12px; border-radius: 50%; margin: 0 5px 0 10px; vertical-align: -1px; }
.view-legend i:first-child { margin-left: 0; } .view-legend i.ramp { width: 90px; border-radius: 6px;
  background: linear-gradient(90deg, #440154, #3b528b, #21918c, #5ec962, #fde725); }
.scale path { stroke: var(--quiet); fill: none; stroke-width: 1.5; }
.legend { display: flex; flex-wrap: wrap; gap: 6px 22px; align-items: center; font-size: 13px; color: var(--quiet); margin-top: 12px; }
.legend .keys { display: inline-flex; flex-wrap: wrap; align-items: center; gap: 4px 7px; } .legend label { margin-left: 6px; cursor: pointer; }
.swatch { width: 20px; height: 5px; border-radius: 3px; margin-left: 5px; } .swatch.c0 { background: var(--c0); } .swatch.c1 { background: var(--c1); }
.swatch.c2 { background: var(--c2); } .swatch.c3 { background: var(--c3); } .swatch.c4 { background: var(--c4); }
.swatch.square { height: 12px; width: 12px; } .swatch.ambiguous { border: 2px solid var(--ambiguous); } .swatch.rejected { background: var(--rejected); }
.swatch.failed { background: var(--failed); } .swatch.overlap { background: var(--land); }
.by-r, .hue-r .by-p { display: none !important; } .hue-r .by-r { display: inline-flex !important; }
svg.key { width: 34px; height: 10px; margin-left: 8px; } svg.key.round { width: 20px; height: 20px; }
.matrix .sheet { fill: var(--sea); } .matrix rect { stroke: none; } .matrix rect.diagonal { fill: var(--rule); }
.bars .ambiguous { fill: var(--ambiguous); }
.matrix rect.ambiguous { fill: var(--card); stroke: var(--ambiguous); stroke-width: 1.6; } .matrix rect.rejected, .bars .rejected { fill: var(--rejected); }
.matrix rect.failed { fill: var(--failed); } .matrix rect.overlap { fill: var(--land); } .matrix rect:hover { stroke: var(--ink); stroke-width: 1.5; }
.matrix .row { text-anchor: end; } .bars .accepted { fill: var(--accepted); } .bars text { text-anchor: middle; } .bars .t0 { text-anchor: start; } .bars .t2 { text-anchor: end; }
.bars .axis { stroke: var(--rule); } figure { margin: 0 0 14px; } figcaption { margin-top: 4px; }
.scroll { overflow: auto; max-height: 560px; border: 1px solid var(--rule); border-radius: 10px; background: var(--card); }
table { border-collapse: collapse; width: 100%; font-size: 13.5px; } td, th { padding: 5px 8px; text-align: left; vertical-align: top; white-space: nowrap; }
.sortable th { position: sticky; top: 0; background: var(--card); box-shadow: inset 0 -1px var(--rule); cursor: pointer; font-weight: 600; z-index: 1;
  white-space: normal; vertical-align: bottom; } .sortable th.n { text-align: right; }
.sortable th:hover { color: var(--accent); } th.up::after { content: " ↑"; } th.down::after { content: " ↓"; }
tbody tr + tr td { border-top: 1px solid var(--rule); } .sortable tbody tr { cursor: pointer; } .sortable tbody tr:hover { background: var(--sea); }
tr.hot, .sortable tbody tr.hot:hover { background: var(--mark); box-shadow: inset 4px 0 var(--pick); } tr.near { box-shadow: inset 4px 0 var(--pick); }
:focus-visible { outline: 2px solid var(--pick); outline-offset: -2px; }
td.n { text-align: right; font-variant-numeric: tabular-nums; } td.why { white-space: normal; min-width: 190px; color: var(--quiet); }
.pill { font-size: 12px; font-weight: 600; padding: 1px 9px; border-radius: 99px; border: 1px solid currentColor; }
.pill.accepted, .pill.placed { color: var(--accepted); } .pill.ambiguous, .pill.unplaced { color: var(--ambiguous); }
.pill.rejected { color: var(--quiet); } .pill.failed { color: var(--failed); }
.filters { display: flex; flex-wrap: wrap; gap: 8px; margin-bottom: 8px; } .filters button, .filters input { font: inherit; font-size: 13px;
  color: var(--ink); background: var(--card); border: 1px solid var(--rule); border-radius: 99px; padding: 3px 14px; }
.filters button { cursor: pointer; } .filters button[aria-pressed=true] { background: var(--accent); border-color: var(--accent); color: var(--card); }
.filters .count { margin-left: auto; align-self: center; } .filters input { min-width: 340px; }
ul.missing { list-style: none; padding: 0; margin: 0; } .missing li { background: var(--card); border: 1px solid var(--rule); border-left: 4px solid var(--ambiguous);
  border-radius: 8px; padding: 10px 16px; margin-bottom: 8px; } .missing li.failed { border-left-color: var(--failed); } .missing p { margin: 4px 0 0; color: var(--quiet); }
.warnings li { margin-bottom: 4px; } details { margin: 10px 0; } summary { cursor: pointer; font-weight: 600; }
pre { overflow: auto; background: var(--card); border: 1px solid var(--rule); border-radius: 8px; padding: 12px 16px; font-size: 12.5px; max-height: 480px; }
.facts { width: auto; } .facts th { color: var(--quiet); font-weight: 500; } .facts td { white-space: normal; word-break: break-all; }
.times th { font-weight: 500; width: 1%; } .times td.n { width: 1%; } .times .bar i { display: block; height: 9px; margin-top: 6px; border-radius: 5px; background: var(--accent); min-width: 2px; }
@media print { .filters, .switch, .view-bar { display: none; } .scroll { max-height: none; overflow: visible; border: 0; } body { background: #fff; font-size: 11px; }
  main { max-width: none; padding: 0; } .card, figure, li, tr { break-inside: avoid; } h2 { break-after: avoid; } details { display: none; }
  table { font-size: 9px; } td, th { padding: 2px 5px; } td.why { min-width: 0; } }
)css";

}  // namespace isthmus::report
