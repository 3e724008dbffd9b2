// Makes licences.txt: the packages that the app is made of, with the texts of their licences. The app and the Debian package
// hand it on.
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import type { Plugin } from "vite";

const modules = join(import.meta.dirname, "../node_modules");

export function licences(): Plugin {
  return {
    name: "docent-licences",
    apply: "build",
    generateBundle(_, bundle) {
      const used = new Set<string>();
      for (const chunk of Object.values(bundle))
        if (chunk.type === "chunk")
          for (const id of chunk.moduleIds)
            used.add(/.*\/node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(id)?.[1] ?? "");
      // Styles and fonts come by @import, which the bundle does not list; helpers of the build stand in the scripts as well.
      const { dependencies } = JSON.parse(
        readFileSync(join(import.meta.dirname, "../package.json"), "utf8"),
      ) as { dependencies: Record<string, string> };
      for (const name of Object.keys(dependencies).filter((one) => one.startsWith("@fontsource")))
        used.add(name);
      used.add("vite");
      used.delete("");
      this.emitFile({ type: "asset", fileName: "licences.txt", source: licencesText([...used].sort()) });
    },
  };
}

export function licencesText(names: readonly string[]): string {
  const texts = names.map((name) => {
    const folder = join(modules, name);
    const about = JSON.parse(readFileSync(join(folder, "package.json"), "utf8")) as {
      version: string;
      license?: string;
      author?: string | { name?: string };
    };
    if (!about.license) throw new Error(`the package ${name} names no licence`);
    const file = readdirSync(folder).find((one) => /^(licen[cs]e|copying)/i.test(one));
    const author = typeof about.author === "string" ? about.author : (about.author?.name ?? "");
    const text = file
      ? readFileSync(join(folder, file), "utf8").trim()
      : `Copyright: ${author || "the authors of the package"}. The package has no text of its licence, ${about.license}.`;
    return {
      name,
      version: about.version,
      licence: about.license,
      text: name === "vite" ? (text.split(/\n# Licenses of bundled dependencies/)[0] ?? text).trim() : text,
    };
  });
  const line = "-".repeat(100);
  const list = texts.map((t) => `${t.name} ${t.version}: ${t.licence}`).join("\n");
  return `The browser app of Docent is made of its own code (Apache-2.0) and of these packages:\n\n${list}\n\n${texts.map((t) => `${line}\n${t.name} ${t.version}: ${t.licence}\n${line}\n\n${t.text}\n`).join("\n")}`;
}
