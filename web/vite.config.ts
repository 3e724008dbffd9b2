import { resolve } from "node:path";
import react from "@vitejs/plugin-react";
import { defineConfig, type Plugin } from "vite";
import { licences } from "./plugins/licences";
import { visitWorker } from "./plugins/visit_worker";

// Where `npm run dev` finds a server: the HTTP address of `docent serve`.
const server = process.env["DOCENT_HTTP"] ?? "http://127.0.0.1:7480";

// As `docent serve` does: /visit is visit.html.
const pages: Plugin = {
  name: "docent-pages",
  configureServer({ middlewares }) {
    middlewares.use((request, _, next) => {
      if (/^\/visit(\?|$)/.test(request.url ?? ""))
        request.url = request.url?.replace("/visit", "/visit.html");
      next();
    });
  },
};

export default defineConfig({
  plugins: [react(), pages, visitWorker(), licences()],
  html: { cspNonce: "docent-csp-nonce" }, // the server puts another one into each answer
  build: {
    target: "es2022",
    sourcemap: false,
    chunkSizeWarningLimit: 700,
    assetsInlineLimit: 0,
    rollupOptions: {
      input: {
        index: resolve(import.meta.dirname, "index.html"),
        visit: resolve(import.meta.dirname, "visit.html"),
      },
    },
  },
  server: {
    host: "127.0.0.1",
    proxy: { "/docent.v1.": server, "/live": { target: server, ws: true }, "/visit/": server },
  },
});
