// Bundles the view into one script and writes it as C++: node build.mjs OUTPUT.cpp [OUTPUT.js]
import { build } from "esbuild";
import { writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const [cpp, js] = process.argv.slice(2);
const result = await build({
  entryPoints: [join(here, "src/view.js")],
  bundle: true, minify: true, write: false, format: "iife", target: "es2020", charset: "ascii", legalComments: "inline",
  nodePaths: process.env.ISTHMUS_NODE_MODULES ? [process.env.ISTHMUS_NODE_MODULES] : [],
});
const text = result.outputFiles[0].text;
if (text.includes(')view"')) throw new Error("the bundle holds the end of the literal");
// One literal may not be too long for a compiler; neighbours are joined.
const pieces = text.match(/[\s\S]{1,8000}/g).map(piece => `R"view(${piece})view"`);
writeFileSync(cpp, `// Made by tools/report_view/build.mjs.\n#include "report/view_script.h"\n\nnamespace isthmus::report {\n\n` +
  `const char* const kViewScript =\n${pieces.join("\n")};\n\n}  // namespace isthmus::report\n`);
if (js) writeFileSync(js, text);
