import { defineConfig } from "vitest/config";

// A busy machine makes tests slow, not wrong: what is waited for comes at last, and these are only the ends of patience.
const patience = {
  testTimeout: 900_000,
  hookTimeout: 600_000,
  teardownTimeout: 120_000,
  expect: { poll: { timeout: 300_000 } },
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
