import react from "@vitejs/plugin-react";
import { defineConfig } from "vite";

// Where `npm run dev` finds a server: the HTTP address of `docent serve`.
const server = process.env["DOCENT_HTTP"] ?? "http://127.0.0.1:7480";

export default defineConfig({
  plugins: [react()],
  html: { cspNonce: "docent-csp-nonce" }, // the server puts another one into each answer
  build: { target: "es2022", sourcemap: false, chunkSizeWarningLimit: 700, assetsInlineLimit: 0 },
  server: { host: "127.0.0.1", proxy: { "/docent.v1.": server, "/live": { target: server, ws: true } } },
});
