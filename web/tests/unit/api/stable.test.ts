import { expect, test } from "vitest";
import { isSame } from "../../../src/api/stable";

test("plain data is the same by what is in it", () => {
  expect(
    isSame({ a: [1, new Map([["x", new Set([2n])]])] }, { a: [1, new Map([["x", new Set([2n])]])] }),
  ).toBe(true);
  expect(isSame({ a: 1 }, { a: 1, b: undefined })).toBe(false);
  expect(isSame({ b: undefined }, { a: undefined })).toBe(false);
  expect(isSame([1, 2], [2, 1])).toBe(false);
  expect(isSame(new Map([["x", 1]]), new Map([["x", 2]]))).toBe(false);
  expect(isSame(new Set(["x"]), new Set(["x", "y"]))).toBe(false);
  expect(isSame([], {})).toBe(false);
  expect(isSame(new Set(["x", "y"]), new Set(["y", "x"]))).toBe(true);
  expect(isSame(null, {})).toBe(false);
  expect(isSame(NaN, NaN)).toBe(true);
});
