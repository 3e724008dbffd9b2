import { expect, it } from "vitest";
import { createStore } from "../../../src/api/store";

it("a store tells of another value, until a listener is gone", () => {
  const store = createStore(1);
  const heard: number[] = [];
  const stop = store.subscribe(() => heard.push(store.get()));
  store.set(2);
  store.set(2);
  expect(heard).toEqual([2]);
  stop();
  store.set(3);
  expect([store.get(), ...heard]).toEqual([3, 2]);
});
it("a listener that goes while it is told is the last of its kind, not of all", () => {
  const store = createStore("");
  const heard: string[] = [];
  const stop = store.subscribe(() => (heard.push("first"), stop()));
  store.subscribe(() => heard.push("second"));
  store.set("x");
  store.set("y");
  expect(heard).toEqual(["first", "second", "second"]);
});
