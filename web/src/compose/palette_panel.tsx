// What a step can do, to be dragged onto the canvas, double-clicked, or chosen by Enter.
import { Import, PanelLeftClose, Search, Unplug } from "lucide-react";
import { useState } from "react";
import { score } from "../ui/picker";
import type { NewKind } from "./actions";
import { dragged, dragType } from "./canvas";
import type { PaletteData, PaletteEntry } from "../flow/palette_data";
import { KindIcon } from "../flow/step_card";

const groups = [
  {
    kind: "service",
    title: "Services",
    says: "What any robot that is free can do for the run.",
    hint: "Register RSEL documents to have some.",
  },
  {
    kind: "operation",
    title: "Robots' operations",
    says: "Single commands that the robots here know.",
    hint: "They come when a robot joins.",
  },
  {
    kind: "workflow",
    title: "Workflows",
    says: "Whole flows that are deployed, run as one step.",
    hint: "Deployed workflows appear here. Each can be a step of another one.",
  },
] as const;

export function PalettePanel(props: {
  palette: PaletteData;
  name: string;
  onAdd: (what: NewKind) => void;
  onImport: () => void;
  onHide: () => void;
}) {
  const [typed, setTyped] = useState("");
  const shown = props.palette.entries.filter(
    (e) => e.id !== props.name && score({ title: e.title, words: e.id }, typed) > 0,
  );
  return (
    <aside className="palette" aria-label="Palette">
      <div className="palette-search">
        <Search size={14} aria-hidden />
        <input
          value={typed}
          onChange={(e) => setTyped(e.target.value)}
          placeholder="Find a step"
          aria-label="Find a step"
          onKeyDown={(e) => e.key === "Escape" && setTyped("")}
        />
        <button
          className="button plain icon small"
          aria-label="Hide the palette"
          title="Hide the palette"
          onClick={props.onHide}
        >
          <PanelLeftClose size={15} />
        </button>
      </div>
      <div className="palette-list">
        {typed === "" && (
          <section>
            <h2>Basics</h2>
            <PaletteItem
              what={{ kind: "empty", title: "Step" }}
              title="Empty step"
              detail="waits for a situation"
              onAdd={props.onAdd}
            />
          </section>
        )}
        {props.palette.error && (
          <div className="notice wait">
            <Unplug size={15} />
            <div>
              <b>{props.palette.error.title}.</b> {props.palette.error.detail} Steps of the server come back
              with it.
            </div>
          </div>
        )}
        {groups.map((group) => {
          const entries = shown.filter((e) => e.kind === group.kind);
          if (entries.length === 0 && (typed !== "" || props.palette.error || props.palette.loading))
            return null;
          return (
            <section key={group.kind}>
              <h2>{group.title}</h2>
              {entries.length > 0 && typed === "" && <p className="faint small palette-hint">{group.says}</p>}
              {entries.length === 0 && <p className="faint small palette-hint">{group.hint}</p>}
              {entries.map((e) => (
                <PaletteItem key={e.id} what={e} title={e.title} detail={e.detail} onAdd={props.onAdd} />
              ))}
            </section>
          );
        })}
        {typed === "" && (
          <button className="button plain small palette-import" onClick={props.onImport}>
            <Import size={13} />
            Import from WSDL or gRPC
          </button>
        )}
        {typed !== "" && shown.length === 0 && (
          <p className="faint small palette-hint">Nothing is called “{typed}”.</p>
        )}
      </div>
    </aside>
  );
}

function PaletteItem(props: {
  what: PaletteEntry | { kind: "empty"; title: string };
  title: string;
  detail: string;
  onAdd: (what: NewKind) => void;
}) {
  return (
    <button
      className="palette-item"
      draggable
      title="Drag it onto the canvas, or press Enter"
      onDragStart={(e) => {
        dragged.what = props.what;
        e.dataTransfer.setData(dragType, JSON.stringify(props.what));
        e.dataTransfer.effectAllowed = "copy";
      }}
      onDragEnd={() => (dragged.what = null)}
      onDoubleClick={() => props.onAdd(props.what)}
      onKeyDown={(e) => e.key === "Enter" && (e.preventDefault(), props.onAdd(props.what))}
    >
      <span className={`palette-icon ${props.what.kind}`}>
        <KindIcon kind={props.what.kind} size={14} />
      </span>
      <span className="palette-words">
        <span className="cut">{props.title}</span>
        {props.detail && <span className="faint cut">{props.detail}</span>}
      </span>
    </button>
  );
}
