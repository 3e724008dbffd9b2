// Starts what a favourite stands for.
import { create } from "@bufbuild/protobuf";
import { services, workflows } from "../api/client";
import { randomUuid } from "../api/ids";
import { termOf } from "../api/terms";
import { writtenValue } from "../cawl/values";
import { type NamedTerm, NamedTermSchema } from "../gen/docent/v1/term_pb";
import type { Favourite } from "./favourites";

// The id of the run. Throws RangeError for a value that can't be read, and what the server says.
export async function start(
  favourite: Favourite,
  values: Readonly<Record<string, string>>,
  prefixes: ReadonlyMap<string, string>,
): Promise<string> {
  const given = Object.entries(values)
    .filter(([, text]) => text.trim() !== "")
    .map(([name, text]): NamedTerm =>
      create(NamedTermSchema, { name, value: termOf(writtenValue(text, ""), prefixes) }),
    );
  const requestId = randomUuid();
  if (favourite.kind === "workflow")
    return (
      await workflows.start({ workflow: favourite.name, flow: favourite.flow, variables: given, requestId })
    ).run;
  // The first message names the run; the run goes on without somebody who follows it.
  const enough = new AbortController();
  try {
    for await (const reply of services.invoke(
      { name: favourite.name, arguments: given, requestId },
      { signal: enough.signal },
    ))
      if (reply.run) return reply.run;
    return "";
  } finally {
    enough.abort();
  }
}
