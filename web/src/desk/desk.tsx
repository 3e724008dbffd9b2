// The front desk: favourites that are started by one touch, and what runs now.
import { Bot, Link as LinkIcon, Plus, Settings2, Star, Trash2, Workflow, Wrench } from "lucide-react";
import { useEffect, useMemo, useRef, useState } from "react";
import { plain } from "../api/errors";
import { type Names, useNames } from "../api/prefixes";
import { useStable } from "../api/stable";
import { kept as storage } from "../api/storage";
import { useCommands } from "../ui/commands";
import { navigate, paths } from "../ui/router";
import { words } from "../cawl/names";
import { type PaletteData, type PaletteEntry, usePalette, withInputs } from "../flow/palette_data";
import { useVocabulary } from "../facts/vocabulary";
import { Dialog } from "../ui/dialog";
import { Picker } from "../ui/picker";
import { toast } from "../ui/toasts";
import {
  type Favourite,
  favouritesSearch,
  favouriteText,
  keepFavourites,
  keptFavourites,
  mostFavourites,
  readFavourites,
  titleOf,
} from "./favourites";
import { AskDialog } from "./ask_dialog";
import { RunningNow } from "./running_now";
import { runWords } from "../ui/states";
import { start } from "./start";
import "./desk.css";

export default function Desk({ search }: { search: string }) {
  const names = useNames();
  const palette = usePalette();
  const [kept, setKept] = useState(() => keptFavourites(storage));
  const linked = useMemo(() => readFavourites(search), [search]);
  const shown = linked.length > 0 ? linked : kept;
  const [editing, setEditing] = useState(false);
  const [adding, setAdding] = useState(false);
  const [asking, setAsking] = useState<{ favourite: Favourite; entry: PaletteEntry; edit: boolean } | null>(
    null,
  );
  const starts = useRef<(HTMLButtonElement | null)[]>([]); // the large buttons
  useEffect(() => void (document.title = "Front desk – Docent"), []);
  // Changes of favourites that came by a link change the address, those of one's own what the browser keeps.
  const put = (next: Favourite[]) => {
    if (linked.length > 0) return navigate(paths.desk(favouritesSearch(next)), true);
    setKept(next);
    if (!keepFavourites(next, storage))
      toast("bad", "This browser keeps nothing", "Copy the link: it has the favourites.");
  };
  const share = () => {
    const address = `${location.origin}${paths.desk(favouritesSearch(shown))}`;
    navigator.clipboard.writeText(address).then(
      () => toast("good", "The link is copied", "It shows these favourites in any browser."),
      () => toast("bad", "The link could not be copied", address),
    );
  };
  const add = async (entry: PaletteEntry) => {
    const favourite: Favourite = {
      kind: entry.kind === "workflow" ? "workflow" : "service",
      name: entry.id,
      flow: "",
      title: "",
      values: {},
    };
    const whole = await withInputs(entry);
    setAsking({ favourite, entry: whole, edit: true });
  };
  useCommands([
    { title: "Add a favourite", group: "Front desk", icon: Plus, keys: "A", run: () => setAdding(true) },
    { title: "Copy the link to these favourites", group: "Front desk", icon: LinkIcon, run: share },
    ...shown.slice(0, 9).map((f, i) => ({
      title: `Start ${titleOf(f)}`,
      group: "Front desk",
      icon: Star,
      keys: `${i + 1}`,
      run: () => starts.current[i]?.click(),
    })),
  ]);
  const offered = palette.entries.filter((e) => e.kind !== "operation");
  return (
    <main className="page view-page">
      <header className="head">
        <h1>Front desk</h1>
        <span className="grow" />
        {shown.length > 0 && (
          <button className="button" onClick={share}>
            <LinkIcon size={14} />
            Copy the link
          </button>
        )}
        {shown.length > 0 && (
          <button className="button" aria-pressed={editing} onClick={() => setEditing(!editing)}>
            <Settings2 size={14} />
            Change
          </button>
        )}
        <button className="button primary" onClick={() => setAdding(true)}>
          <Plus size={15} />
          Add
        </button>
      </header>
      <div className="view desk" tabIndex={0} aria-label="Front desk">
        {linked.length > 0 && (
          <div className="notice desk-linked">
            <LinkIcon size={15} />
            <div className="grow">
              <b>These favourites come by a link.</b> This browser has{" "}
              {kept.length === 0 ? "none" : kept.length} of its own.
            </div>
            <button
              className="button small"
              onClick={() => (keepAll(kept, linked, setKept), navigate(paths.desk()))}
            >
              Keep them here
            </button>
            {kept.length > 0 && (
              <button className="button small" onClick={() => navigate(paths.desk())}>
                Show my own
              </button>
            )}
          </div>
        )}
        {shown.length === 0 && (
          <div className="nothing">
            <Star size={28} />
            <h2>No favourites yet</h2>
            <p>
              Add the workflows and services that are started often. Each is a large button; what it needs is
              asked for in a small form.
            </p>
            <button className="button primary" onClick={() => setAdding(true)}>
              <Plus size={15} />
              Add a favourite
            </button>
          </div>
        )}
        <ul className="desk-tiles">
          {shown.map((favourite, i) => (
            <Tile
              key={`${favouriteText(favourite)} ${i}`}
              favourite={favourite}
              palette={palette}
              names={names}
              editing={editing}
              number={i + 1}
              startButton={(button) => void (starts.current[i] = button)}
              onAsk={(entry, edit) => setAsking({ favourite, entry, edit })}
              onRemove={() => put(shown.filter((_, k) => k !== i))}
            />
          ))}
        </ul>
        <RunningNow />
      </div>
      {adding && (
        <Dialog label="Add a favourite" width={520} top onClose={() => setAdding(false)}>
          <Picker
            label="Workflows and services"
            placeholder="What should be started by one touch?"
            empty="Nothing here has this name. Deploy a workflow, or register services."
            onDone={() => setAdding(false)}
            items={offered.map((e) => ({
              id: `${e.kind} ${e.id}`,
              title: e.title,
              group: e.kind === "workflow" ? "Workflows" : "Services",
              detail: [e.kind, e.detail].filter(Boolean).join(" · "),
              words: e.id,
              icon: e.kind === "workflow" ? <Workflow size={16} /> : <Wrench size={16} />,
              run: () => void add(e),
            }))}
          />
        </Dialog>
      )}
      {asking && (
        <AskDialog
          favourite={asking.favourite}
          entry={asking.entry}
          edit={asking.edit}
          names={names}
          onClose={() => setAsking(null)}
          onKeep={(favourite) =>
            put(
              shown.includes(asking.favourite)
                ? shown.map((f) => (f === asking.favourite ? favourite : f))
                : [...shown, favourite].slice(0, mostFavourites),
            )
          }
        />
      )}
    </main>
  );
}

function keepAll(
  kept: readonly Favourite[],
  linked: readonly Favourite[],
  setKept: (next: Favourite[]) => void,
) {
  const have = new Set(kept.map(favouriteText));
  const next = [...kept, ...linked.filter((f) => !have.has(favouriteText(f)))].slice(0, mostFavourites);
  setKept(next);
  if (keepFavourites(next, storage)) toast("good", "The favourites are kept in this browser");
  else
    toast(
      "bad",
      "This browser keeps nothing",
      "The favourites last as long as this page. Copy the link: it has them.",
    );
}

const rest = 1500; // after a touch, so that a double one starts one run

function Tile(props: {
  favourite: Favourite;
  palette: PaletteData;
  names: Names;
  editing: boolean;
  number: number;
  startButton: (button: HTMLButtonElement | null) => void;
  onAsk: (entry: PaletteEntry, edit: boolean) => void;
  onRemove: () => void;
}) {
  const { favourite, palette, names } = props;
  const vocabulary = useVocabulary(names.prefixes);
  const entry = useStable(palette.entries.find((e) => e.kind === favourite.kind && e.id === favourite.name));
  const [inputs, setInputs] = useState<PaletteEntry["inputs"] | null>(null);
  const [busy, setBusy] = useState(false);
  const timer = useRef(0);
  useEffect(() => {
    let there = true;
    if (entry) void withInputs(entry).then((whole) => there && setInputs(whole.inputs));
    return () => void (there = false);
  }, [entry]);
  useEffect(() => () => window.clearTimeout(timer.current), []);
  const asked = (inputs ?? []).filter((i) => !i.optional && !favourite.values[i.name]);
  const label = (value: string) =>
    vocabulary.things.find((t) => t.term === value)?.label || value.replace(/^[\w-]+:/, "");
  const touch = () => {
    if (busy || !entry || !inputs) return;
    if (asked.length > 0) return props.onAsk({ ...entry, inputs }, false);
    setBusy(true);
    timer.current = window.setTimeout(() => setBusy(false), rest);
    start(favourite, favourite.values, names.prefixes).then(
      (run) =>
        toast("good", `${titleOf(favourite)} has begun`, runWords(run), {
          label: "Open it",
          run: () => navigate(paths.run(run)),
        }),
      (error: unknown) => {
        const { title, detail } =
          error instanceof RangeError
            ? { title: "A value can't be read", detail: error.message }
            : plain(error);
        toast("bad", `${titleOf(favourite)} did not begin`, [title, detail].filter(Boolean).join(". "));
      },
    );
  };
  const missing = !entry && !palette.loading && !palette.error;
  const Icon = favourite.kind === "workflow" ? Workflow : Bot;
  return (
    <li className="desk-tile">
      <button
        ref={props.startButton}
        className="desk-start"
        disabled={busy || missing}
        onClick={touch}
        aria-keyshortcuts={props.number < 10 ? `${props.number}` : undefined}
      >
        <span className={`desk-icon ${favourite.kind}`}>
          <Icon size={24} />
        </span>
        <span className="grow">
          <b>{titleOf(favourite)}</b>
          <span className="quiet">
            {Object.entries(favourite.values)
              .filter(([, v]) => v)
              .map(([, v]) => label(v))
              .join(", ")}
          </span>
          <span className="faint small">
            {missing ? "" : `${favourite.kind}${inputs ? ", " : ""}`}
            {missing
              ? `No ${favourite.kind} of this name is here now`
              : asked.length > 0
                ? `asks for ${asked.map((i) => words(i.name).toLowerCase()).join(", ")}`
                : inputs
                  ? "starts at once"
                  : ""}
          </span>
        </span>
        {props.number < 10 && <kbd aria-hidden>{props.number}</kbd>}
      </button>
      {props.editing && (
        <span className="desk-edit">
          <button
            className="button small"
            disabled={!entry || !inputs}
            onClick={() => entry && inputs && props.onAsk({ ...entry, inputs }, true)}
          >
            <Settings2 size={13} />
            Name and values
          </button>
          <button
            className="button plain icon small"
            aria-label={`Remove ${titleOf(favourite)}`}
            title="Remove"
            onClick={props.onRemove}
          >
            <Trash2 size={14} />
          </button>
        </span>
      )}
    </li>
  );
}
