// Refuses room and sizes of text that are not from the scale of tokens.css (--space-*, --text-*): `node lint/check_sizes.js`, in web/.
// Free are 0, 1px, and more than 40px, which is room for something else than distance.
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";

const source = join(import.meta.dirname, "../src");
const tokens = join("ui", "tokens.css");
const inSheet = /(?:^|[;{])\s*((?:row-|column-)?gap|(?:padding|margin)[a-z-]*|font-size):([^;{}]*)/gm;
const inStyle = /\b(gap|padding\w*|margin\w*|fontSize): (\d+|"[^"]*")/g;
const free = (px) => px === 0 || px === 1 || px > 40;

const faults = [];
for (const name of readdirSync(source, { recursive: true, encoding: "utf8" }).sort()) {
  if (name === tokens || !/\.(css|tsx)$/.test(name)) continue;
  const text = readFileSync(join(source, name), "utf8").replace(/\/\*[\s\S]*?\*\//g, (comment) =>
    comment.replace(/[^\n]/g, " "),
  );
  const report = (at, property, value) => {
    const numbers = /^\d+$/.test(value)
      ? [Number(value)]
      : [...value.matchAll(/(\d+(?:\.\d+)?)px/g)].map(([, px]) => Number(px));
    const isText = /^font/.test(property);
    if (numbers.some((px) => (isText ? px > 0 : !free(px))))
      faults.push(
        `src/${name}:${text.slice(0, at).split("\n").length}: ${property}: ${value.trim()}: take ${isText ? "--text-*" : "--space-*"} of ${tokens}`,
      );
  };
  if (name.endsWith(".css"))
    for (const found of text.matchAll(inSheet))
      report(found.index + found[0].indexOf(found[1]), found[1], found[2]);
  else
    for (const style of text.matchAll(/style=\{\{([^}]*)\}\}/g))
      for (const found of style[1].matchAll(inStyle)) report(style.index, found[1], found[2]);
}
if (faults.length > 0) {
  console.error(faults.join("\n"));
  process.exitCode = 1;
}
