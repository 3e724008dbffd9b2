// Where a robot's screen is, by what anybody may have told.
import { expect, it } from "vitest";
import { screenAddress } from "../../../src/operate/screen_address";

it("a page's server is the screen, and what is no web address is none", () => {
  expect(screenAddress("http://127.0.0.1:8090/booth-7")).toBe("http://127.0.0.1:8090/");
  for (const none of [
    undefined,
    "",
    "http://h:99999/",
    "http://",
    "https://[::1/",
    "http://a b/",
    "javascript:alert(1)",
    "file:///etc/passwd",
  ])
    expect(screenAddress(none)).toBeUndefined();
});
