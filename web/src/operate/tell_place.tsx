// Where a person or robot is, told by a person who sees it; and any other fact of it.
import { create } from "@bufbuild/protobuf";
import { MapPin, MessageSquarePlus } from "lucide-react";
import { useEffect, useEffectEvent, useRef, useState } from "react";
import { context } from "../api/client";
import { randomUuid } from "../api/ids";
import type { Names } from "../api/prefixes";
import { iriTerm } from "../api/terms";
import { QuadSchema } from "../gen/docent/v1/term_pb";
import type { Layout } from "../hall/layout";
import { attempt } from "./run_actions";
import { TellDialog } from "../facts/tell";

const isAt = "https://w3id.org/docent#isAt";

export function TellPlace({
  iri,
  name,
  layout,
  names,
  asked,
  onAsked,
  again,
}: {
  iri: string;
  name: string;
  layout: Layout | undefined;
  names: Names;
  asked: boolean; // the field of the place is to have the keys
  onAsked: () => void; // it has them
  again: () => void;
}) {
  const field = useRef<HTMLSelectElement>(null);
  const focus = useEffectEvent(() => {
    field.current?.focus();
    onAsked();
  });
  useEffect(() => {
    if (asked) focus();
  }, [asked]);
  const [place, setPlace] = useState("");
  const [telling, setTelling] = useState(false);
  const places = (kind: string) =>
    (layout?.shapes ?? [])
      .filter((s) => s.kind === kind)
      .sort((a, b) => a.name.localeCompare(b.name, undefined, { numeric: true }));
  const tell = (event: React.FormEvent) => {
    event.preventDefault();
    if (!place) return;
    attempt(
      `${name} is at ${names.name(place)}`,
      () =>
        context.assert({
          add: [
            create(QuadSchema, { subject: iriTerm(iri), predicate: iriTerm(isAt), object: iriTerm(place) }),
          ],
          requestId: randomUuid(),
        }),
      () => (setPlace(""), again()),
    );
  };
  return (
    <form className="tell-place" onSubmit={tell}>
      <label className="row">
        <span className="quiet">is at</span>
        <select
          ref={field}
          className="field small grow"
          aria-label={`${name} is at`}
          value={place}
          onChange={(e) => setPlace(e.target.value)}
        >
          <option value="">choose a place</option>
          {(
            [
              ["region", "Regions"],
              ["booth", "Booths"],
            ] as const
          ).map(
            ([kind, title]) =>
              places(kind).length > 0 && (
                <optgroup key={kind} label={title}>
                  {places(kind).map((s) => (
                    <option key={s.iri} value={s.iri}>
                      {[s.name, s.detail].filter(Boolean).join(" · ")}
                    </option>
                  ))}
                </optgroup>
              ),
          )}
        </select>
      </label>
      <button className="button small" disabled={!place}>
        <MapPin size={13} />
        Tell it
      </button>
      <button type="button" className="button plain small" onClick={() => setTelling(true)}>
        <MessageSquarePlus size={13} />
        Tell another fact
      </button>
      {telling && (
        <TellDialog
          title={`Tell a fact of ${name}`}
          quads={[create(QuadSchema, { subject: iriTerm(iri) })]}
          patterns={[]}
          names={names}
          onTold={again}
          onClose={() => setTelling(false)}
        />
      )}
    </form>
  );
}
