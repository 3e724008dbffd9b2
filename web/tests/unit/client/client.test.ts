// The client package: plain values as terms, and the rows of a query that is watched.
import { create } from "@bufbuild/protobuf";
import { describe, expect, it, vi } from "vitest";
import {
  connectDocent,
  docentTerm,
  fact,
  literal,
  namespace,
  type Row,
  type Socket,
  SubscribeReplySchema,
  variable,
} from "../../../client/src/index";
import { WatchedAnswer } from "../../../client/src/watched_answer";

const xsd = "http://www.w3.org/2001/XMLSchema#";
const expo = namespace("https://w3id.org/docent/expo#");

describe("plain values", () => {
  it("are terms of their own datatypes", () => {
    const of = (value: Parameters<typeof literal>[0]) =>
      literal(value).kind.value as { lexical: string; datatype: string };
    expect(
      [true, false, 7, -0, 0.5, 1e21, NaN, -Infinity, 12345678901234567890n, "true", new Date(0)].map((v) => [
        of(v).lexical,
        of(v).datatype.replace(xsd, ""),
      ]),
    ).toEqual([
      ["true", "boolean"],
      ["false", "boolean"],
      ["7", "integer"],
      ["0", "integer"],
      ["0.5", "double"],
      ["1e+21", "double"],
      ["NaN", "double"],
      ["-INF", "double"],
      ["12345678901234567890", "integer"],
      ["true", ""],
      ["1970-01-01T00:00:00.000Z", "dateTime"],
    ]);
    expect(() => literal(new Date(NaN))).toThrow(RangeError);
    expect(literal("x", "", "de").kind.value).toMatchObject({ lexical: "x", language: "de" });
    expect(literal(7, `${xsd}byte`).kind.value).toMatchObject({ lexical: "7", datatype: `${xsd}byte` });
  });
  it("stand in facts and in values of a start", () => {
    expect(fact(expo("Hall"), docentTerm("openNow"), true).object?.kind.value).toMatchObject({
      lexical: "true",
      datatype: `${xsd}boolean`,
    });
    expect(fact(expo("Hall"), docentTerm("isAt"), expo("B05")).object?.kind).toEqual({
      case: "iri",
      value: "https://w3id.org/docent/expo#B05",
    });
    expect(variable("stops", 3)).toMatchObject({
      name: "stops",
      value: { kind: { value: { lexical: "3" } } },
    });
  });
});

const row = (...values: Parameters<typeof literal>[0][]) => ({
  row: { values: values.map((v) => literal(v)) },
  count: 1n,
});
const reply = (values: Parameters<typeof create<typeof SubscribeReplySchema>>[1]) =>
  create(SubscribeReplySchema, values);
const texts = (rows: Row[] | undefined) => rows?.map((r) => r["a"]?.text).sort();

describe("the answer of a query that is watched", () => {
  it("is whole after each change, and a bag", () => {
    const answer = new WatchedAnswer();
    expect(
      texts(
        answer.apply(reply({ reset: true, variables: ["a"], appeared: [row(1), { ...row(2), count: 2n }] })),
      ),
    ).toEqual(["1", "2", "2"]);
    expect(answer.apply(reply({ more: true, disappeared: [row(1)] }))).toBeUndefined();
    expect(texts(answer.apply(reply({ disappeared: [row(2)], appeared: [row("1")] })))).toEqual(["1", "2"]);
    expect(texts(answer.apply(reply({ disappeared: [row(1)], appeared: [row(1)] })))).toEqual(["1", "2"]); // "1" is another term than 1
    expect(texts(answer.apply(reply({ reset: true, variables: ["a"] })))).toEqual([]);
  });
  it("has an unbound variable as undefined", () => {
    expect(
      new WatchedAnswer().apply(
        reply({
          reset: true,
          variables: ["a", "b"],
          appeared: [{ row: { values: [literal(1), {}] }, count: 1n }],
        }),
      ),
    ).toEqual([{ a: { kind: "literal", text: "1", datatype: `${xsd}integer` }, b: undefined }]);
  });
  it("of an ASK is one row or none", () => {
    const answer = new WatchedAnswer();
    expect(answer.apply(reply({ reset: true, isBoolean: true, boolean: true }))).toEqual([{}]);
    expect(answer.apply(reply({ isBoolean: true, boolean: false }))).toEqual([]);
  });
  it("comes over the live connection, with plain requests; a refusal ends it", () => {
    const sockets: (Socket & { url: string; sent: { id: number; call: string; request: unknown }[] })[] = [];
    vi.stubGlobal(
      "WebSocket",
      class {
        readyState = 1;
        onmessage = null;
        onclose = null;
        sent: never[] = [];
        constructor(readonly url: string) {
          sockets.push(this);
        }
        send(text: string) {
          this.sent.push(JSON.parse(text) as never);
        }
        close() {}
      },
    );
    const docent = connectDocent("http://127.0.0.1:7480");
    const seen: string[] = [];
    const stop = docent.watch("SELECT ?a { ?a ?b ?c }", (rows) => seen.push(String(texts(rows))), {
      everyMs: 50,
      onEnd: (error) => seen.push(`end: ${error?.message}`),
    });
    const say = (message: object) => sockets[0]?.onmessage?.({ data: JSON.stringify(message) });
    say({ hello: {} });
    expect(sockets[0]?.url).toBe("ws://127.0.0.1:7480/live");
    const [sent] = sockets[0]?.sent ?? [];
    expect(sent).toMatchObject({
      call: "docent.v1.Context/Subscribe",
      request: { query: "SELECT ?a { ?a ?b ?c }", minIntervalMs: 50 },
    });
    const message = {
      reset: true,
      variables: ["a"],
      appeared: [{ row: { values: [{ literal: { lexical: "x" } }] }, count: "1" }],
    };
    say({ id: sent?.id, message, resume: "1" });
    say({ id: sent?.id, refused: { message: "no such query" } });
    expect(seen).toEqual(["x", "end: no such query"]);
    stop();
    vi.unstubAllGlobals();
  });
});
