import { defineConfig } from "vitest/config";

export default defineConfig({ test: { include: ["tests/**/*.test.ts"], environment: "node", testTimeout: 120_000, fileParallelism: false, hookTimeout: 60_000 } });
