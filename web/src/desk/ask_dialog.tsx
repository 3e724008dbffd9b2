// Asks for what a favourite needs, to start it; or gives it a name and values of its own.
import { CircleAlert, Play, Star, X } from "lucide-react";
import { useState } from "react";
import { plain, type PlainError } from "../api/errors";
import { nameChosen, namePatterns } from "../api/labels";
import { usePoll } from "../api/poll";
import type { Names } from "../api/prefixes";
import { localName, query } from "../api/sparql";
import { termOf } from "../api/terms";
import { navigate, paths } from "../ui/router";
import { words } from "../cawl/names";
import type { PaletteEntry } from "../flow/palette_data";
import { Combo, type Choice } from "../ui/combo";
import { Dialog } from "../ui/dialog";
import { toast } from "../ui/toasts";
import { type Favourite, titleOf } from "./favourites";
import { runWords } from "../ui/states";
import { start } from "./start";

export function AskDialog(props: {
  favourite: Favourite;
  entry: PaletteEntry;
  edit: boolean;
  names: Names;
  onKeep: (favourite: Favourite) => void;
  onClose: () => void;
}) {
  const { favourite, entry, edit, names } = props;
  const [title, setTitle] = useState(favourite.title);
  const [values, setValues] = useState<Record<string, string>>({ ...favourite.values });
  const [busy, setBusy] = useState(false);
  const [error, setError] = useState<PlainError | null>(null);
  const types = [
    ...new Set(entry.inputs.map((i) => i.type).filter((type) => /^[^\s<>"{}|^`\\]+$/.test(type))),
  ];
  const things = usePoll(
    types.length > 0 ? `things ${types.join(" ")}` : "",
    async (signal) =>
      new Map(
        await Promise.all(
          types.map(async (type): Promise<[string, Choice[]]> => [type, await thingsOf(type, names, signal)]),
        ),
      ),
    30_000,
  );
  const inputs = edit ? entry.inputs : entry.inputs.filter((i) => !i.optional && !favourite.values[i.name]);
  const lacks = inputs.filter((i) => !(values[i.name] ?? "").trim());
  const go = async () => {
    setBusy(true);
    setError(null);
    try {
      const run = await start(favourite, values, names.prefixes);
      toast("good", `${titleOf(favourite)} has begun`, runWords(run), {
        label: "Open it",
        run: () => navigate(paths.run(run)),
      });
      props.onClose();
    } catch (failure) {
      setError(
        failure instanceof RangeError
          ? { kind: "refused", title: "A value can't be read", detail: failure.message }
          : plain(failure),
      );
      setBusy(false);
    }
  };
  const keep = () => {
    try {
      for (const text of Object.values(values)) if (text.trim()) termOf(text, names.prefixes);
    } catch (failure) {
      return setError({
        kind: "refused",
        title: "A value can't be read",
        detail: failure instanceof Error ? failure.message : "",
      });
    }
    props.onKeep({
      ...favourite,
      title: title.trim(),
      values: Object.fromEntries(Object.entries(values).filter(([, v]) => v.trim())),
    });
    props.onClose();
  };
  return (
    <Dialog label={edit ? "Favourite" : titleOf(favourite)} width={460} onClose={props.onClose}>
      <form className="desk-ask" onSubmit={(e) => (e.preventDefault(), edit ? keep() : void go())}>
        <div className="sheet-head">
          <h2 className="grow">{edit ? words(favourite.name) : titleOf(favourite)}</h2>
          <button
            type="button"
            className="button plain icon small"
            aria-label="Close"
            onClick={props.onClose}
          >
            <X size={15} />
          </button>
        </div>
        <div className="sheet-body" style={{ display: "grid", gap: "var(--space-6)" }}>
          {edit && (
            <label className="property">
              <span>Text on the button</span>
              <input
                className="field"
                data-first
                value={title}
                placeholder={words(favourite.name)}
                maxLength={60}
                onChange={(e) => setTitle(e.target.value)}
              />
            </label>
          )}
          {edit && inputs.length > 0 && (
            <p className="quiet">
              Values that are always the same. What is left empty is asked for at each start.
            </p>
          )}
          {inputs.map((input, i) => (
            <label key={input.name} className="property">
              <span>{words(input.name)}</span>
              <Combo
                label={words(input.name)}
                placeholder={input.optional ? "any" : edit ? "asked for" : typeWords(input.type)}
                value={values[input.name] ?? ""}
                choices={things.data?.get(input.type) ?? []}
                autoFocus={!edit && i === 0}
                onChange={(value) => setValues((before) => ({ ...before, [input.name]: value }))}
              />
            </label>
          ))}
          {error && (
            <div className="notice bad" role="alert">
              <CircleAlert size={15} />
              <div>
                <b>{error.title}.</b> {error.detail}
              </div>
            </div>
          )}
        </div>
        <div className="sheet-foot">
          <button type="button" className="button" onClick={props.onClose}>
            Cancel
          </button>
          {edit ? (
            <button className="button primary">
              <Star size={14} />
              Keep it
            </button>
          ) : (
            <button
              className="button primary"
              disabled={busy || lacks.length > 0}
              title={lacks.length > 0 ? `${words(lacks[0]?.name ?? "")} is missing` : undefined}
            >
              <Play size={14} />
              {busy ? "Starting" : "Start"}
            </button>
          )}
        </div>
      </form>
    </Dialog>
  );
}

// "a booth", "a text", "a whole number": what is wanted, for a field.
function typeWords(type: string): string {
  const name = localName(type);
  return /XMLSchema#/.test(type)
    ? ({ string: "text", boolean: "true or false", integer: "whole number", dateTime: "date and time" }[
        name
      ] ?? (/^(decimal|double|float)$/.test(name) ? "number" : words(name).toLowerCase()))
    : words(name).toLowerCase();
}

// What there is of a class now, by name: "expo:B05", "B05 · Norrgard Lifts".
async function thingsOf(type: string, names: Names, signal: AbortSignal): Promise<Choice[]> {
  const { rows } = await query(
    `PREFIX docent: <https://w3id.org/docent#> PREFIX schema: <https://schema.org/> PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#>
SELECT ?t (${nameChosen} AS ?name) (SAMPLE(?e) AS ?exhibitor) { ?t a <${type}> FILTER(isIRI(?t)) ${namePatterns("?t")} OPTIONAL { ?t docent:exhibitor/schema:name ?e } } GROUP BY ?t ORDER BY ?t LIMIT 1000`,
    signal,
  );
  return rows.map((row) => {
    const iri = row["t"]?.text ?? "";
    return {
      value: names.short(iri) || `<${iri}>`,
      label: [row["name"]?.text, row["exhibitor"]?.text].filter(Boolean).join(" · "),
    };
  });
}
