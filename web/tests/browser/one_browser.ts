// One Chromium for all files of tests in browsers: it starts once, and ends with the last test.
import { chromium } from "playwright-core";
import type { TestProject } from "vitest/node";

declare module "vitest" {
  interface ProvidedContext {
    browser: string; // where it listens
  }
}

export default async function start(project: TestProject): Promise<() => Promise<void>> {
  const server = await chromium.launchServer({
    executablePath: process.env["CHROMIUM"] ?? "/usr/bin/chromium",
    args: ["--no-sandbox"],
    timeout: 300_000,
  });
  project.provide("browser", server.wsEndpoint());
  return () => server.close();
}
