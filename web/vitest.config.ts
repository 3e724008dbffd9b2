import { defineConfig } from "vitest/config";

// How long a test may hang. What is waited for within one ends earlier, and says for what it waited (tests/browser/pages.ts).
// DOCENT_PATIENCE_S makes both longer, for a machine that is busy with something else.
const waitMs = 1000 * Number(process.env["DOCENT_PATIENCE_S"] ?? 30);
const patience = {
  testTimeout: 6 * waitMs,
  hookTimeout: 4 * waitMs,
  teardownTimeout: waitMs,
  expect: { poll: { timeout: waitMs } },
};

export default defineConfig({
  test: {
    fileParallelism: false,
    projects: [
      { test: { name: "unit", include: ["tests/unit/**/*.test.ts"], environment: "node", ...patience } },
      {
        test: {
          name: "browser",
          include: ["tests/browser/**/*.test.ts", "tests/measure/**/*.test.ts"],
          environment: "node",
          globalSetup: "tests/browser/one_browser.ts",
          fileParallelism: false,
          ...patience,
        },
      },
    ],
  },
});
