// Chooses a booth or another place: from a list that is searched, or on the map.
import { List, Map as MapIcon, Search } from "lucide-react";
import { useState } from "react";
import type { Place, Places } from "./places";
import { VisitMap } from "./visit_map";
import { useWords } from "./words";

const iconLetters = 4;
let lastView: "list" | "map" = "list"; // so that Back leads to what was seen

export function PlacePicker(props: {
  title: string;
  hint?: string;
  places: Places;
  list: readonly Place[];
  picked: string;
  onPick: (place: Place) => void;
}) {
  const { say } = useWords();
  const [view, show] = useState(lastView);
  const setView = (next: typeof view) => show((lastView = next));
  const [typed, setTyped] = useState("");
  const words = typed.trim().toLowerCase().split(/\s+/).filter(Boolean);
  const shown = props.list.filter((p) =>
    words.every((word) => `${p.name} ${p.detail}`.toLowerCase().includes(word)),
  );
  return (
    <section aria-labelledby="place-title">
      <h2 id="place-title">{props.title}</h2>
      {props.hint && <p className="visit-hint">{props.hint}</p>}
      <div className="visit-tools">
        <label className="visit-search">
          <Search size={17} aria-hidden />
          <input
            type="search"
            placeholder={say("search")}
            aria-label={say("search")}
            value={typed}
            onChange={(e) => (setTyped(e.target.value), setView("list"))}
          />
        </label>
        <div className="visit-views" role="group">
          <button aria-pressed={view === "list"} onClick={() => setView("list")}>
            <List size={17} aria-hidden />
            {say("view.list")}
          </button>
          <button aria-pressed={view === "map"} onClick={() => setView("map")}>
            <MapIcon size={17} aria-hidden />
            {say("view.map")}
          </button>
        </div>
      </div>
      {view === "map" ? (
        <VisitMap places={props.places} offered={props.list} picked={props.picked} onPick={props.onPick} />
      ) : (
        <ul className="visit-cards">
          {shown.length === 0 && <li className="visit-hint">{say("search.none")}</li>}
          {shown.map((place) => (
            <li key={place.iri}>
              <button
                className="visit-card"
                aria-pressed={place.iri === props.picked}
                onClick={() => props.onPick(place)}
              >
                <span className="visit-icon booth">
                  {place.booth ? place.name.slice(0, iconLetters) : "·"}
                </span>
                <span className="grow">
                  <b>{place.booth && place.detail ? place.detail : place.name}</b>
                  {place.booth && place.detail && place.name.length > iconLetters && (
                    <span>{place.name}</span>
                  )}
                </span>
              </button>
            </li>
          ))}
        </ul>
      )}
    </section>
  );
}
