// Favourites of the front desk: what is kept and what a link says.
import { describe, expect, it } from "vitest";
import {
  type Favourite,
  favouritesSearch,
  favouriteText,
  keepFavourites,
  keptFavourites,
  mostFavourites,
  readFavourite,
  readFavourites,
} from "../../../src/desk/favourites";
import { Random } from "../random";

const guide: Favourite = { kind: "workflow", name: "BoothGuide", flow: "", title: "", values: {} };

describe("favourites", () => {
  it("are short words in a link", () => {
    expect(
      favouriteText({ ...guide, title: "Guide", values: { user: "expo:John", booth: "expo:B05" } }),
    ).toBe("workflow:BoothGuide;title=Guide;$booth=expo:B05;$user=expo:John");
    expect(favouritesSearch([guide])).toBe("?f=workflow%3ABoothGuide");
    expect(favouritesSearch([])).toBe("");
  });
  it("come back as they were, whatever their names are", () => {
    const random = new Random(7);
    const word = () =>
      Array.from({ length: 1 + random.below(12) }, () =>
        random.pick([..."aZ9 ;=%&?#$<>\"'+/\\é한🤖:."]),
      ).join("");
    for (let i = 0; i < 300; i++) {
      const favourites = Array.from({ length: random.below(4) }, (): Favourite => ({
        kind: random.below(2) ? ("workflow" as const) : ("service" as const),
        name: word(),
        flow: random.below(2) ? word() : "",
        title: random.below(2) ? word() : "",
        values: Object.fromEntries(Array.from({ length: random.below(3) }, () => [word(), word()])),
      }));
      expect(readFavourites(favouritesSearch(favourites))).toEqual(favourites);
    }
  });
  it("what is no favourite is passed over, and there is an end to them", () => {
    expect(readFavourite("")).toBeNull();
    expect(readFavourite("robot:R01")).toBeNull();
    expect(readFavourite("workflow:")).toBeNull();
    expect(readFavourite("workflow:A;=x;y;colour=red;%zz=1")).toEqual({ ...guide, name: "A" });
    expect(readFavourites(`?${"f=workflow:A&".repeat(500)}`)).toHaveLength(mostFavourites);
  });
  it("what the browser keeps may be broken or closed", () => {
    expect(keptFavourites({ getItem: () => "{" })).toEqual([]);
    expect(keptFavourites({ getItem: () => '[1,"workflow:BoothGuide",null]' })).toEqual([guide]);
    expect(keepFavourites([guide], { setItem: () => false })).toBe(false);
  });
});
