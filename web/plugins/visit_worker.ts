// Makes visit_worker.js: the service worker of the visitors' page, with the names of all that its page needs.
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import type { Plugin, Rolldown } from "vite";

const always = ["/visit", "/visit.webmanifest", "/icon.svg", "/icon-192.png"];

export function visitWorker(): Plugin {
  return {
    name: "docent-visit-worker",
    apply: "build",
    generateBundle(_, bundle) {
      const files = [...always, ...needed(bundle).map((name) => `/${name}`)];
      const script = readFileSync(join(import.meta.dirname, "visit_worker.js"), "utf8");
      const version = createHash("sha256").update(script).update(files.join()).digest("hex").slice(0, 12);
      this.emitFile({
        type: "asset",
        fileName: "visit_worker.js",
        source: `const version = ${JSON.stringify(version)};\nconst files = ${JSON.stringify(files)};\n${script}`,
      });
    },
  };
}

// Scripts and styles of the page's entry, also those that it loads later; and the Latin letters.
function needed(bundle: Rolldown.OutputBundle): string[] {
  const found = new Set<string>();
  const add = (name: string) => {
    const chunk = bundle[name];
    if (found.has(name) || chunk?.type !== "chunk") return;
    found.add(name);
    const { importedCss = [] } =
      (chunk as { viteMetadata?: { importedCss?: Iterable<string> } }).viteMetadata ?? {};
    for (const style of importedCss) found.add(style);
    for (const next of [...chunk.imports, ...chunk.dynamicImports]) add(next);
  };
  for (const chunk of Object.values(bundle))
    if (chunk.type === "chunk" && chunk.isEntry && chunk.facadeModuleId?.endsWith("visit.html"))
      add(chunk.fileName);
  if (found.size === 0) throw new Error("the build has no page visit.html");
  const letters = Object.keys(bundle).filter((name) => /inter-latin-wght-normal/.test(name));
  return [...found, ...letters].sort();
}
