// A tour from the map: booths clicked in order become a workflow, with what is shown and said at each.
import { ArrowDown, ArrowUp, ChevronDown, ChevronRight, Route, X } from "lucide-react";
import { useState } from "react";
import type { Names } from "../api/prefixes";
import { navigate, paths } from "../ui/router";
import { uniqueName } from "../cawl/names";
import { useLegs } from "./legs";
import { presentS, type Stop, tourChoices, tourSeconds, tourText } from "../cawl/tour";
import { listDrafts, saveDraft } from "../flow/drafts";
import { usePalette } from "../flow/palette_data";
import type { TourDraft } from "./tour_draft";

export function TourPanel(props: {
  tour: TourDraft;
  from: { x: number; y: number } | null;
  names: Names;
  onChange: (tour: TourDraft) => void;
  onMade: () => void;
  onClose: () => void;
}) {
  const { tour } = props;
  const { stops, name, wait, near } = tour;
  const set = (part: Partial<TourDraft>) => props.onChange({ ...tour, ...part });
  const palette = usePalette();
  const offers = palette.entries.filter((e) => e.kind !== "workflow");
  const {
    travel: ways,
    at: choices,
    travelBy: travelling,
    present: proposed,
    speak,
  } = tourChoices(offers, tour.travel);
  const presenting = tour.present ?? proposed;
  const [opened, setOpened] = useState(-1); // the stop whose own choices are shown
  const legs = useLegs(stops, props.from);
  const routed = stops.length > 0 && legs.some((m) => m !== undefined);
  const minutes = tourSeconds(stops, props.from, legs) / 60;
  const change = (index: number, part: Partial<Stop>) =>
    set({ stops: stops.map((s, i) => (i === index ? { ...s, ...part } : s)) });
  const move = (index: number, by: number) => {
    const next = [...stops];
    const [one] = next.splice(index, 1);
    if (one) next.splice(index + by, 0, one);
    setOpened(-1);
    set({ stops: next });
  };
  const make = () => {
    const fresh = uniqueName(
      new Set([
        ...listDrafts().map((d) => d.name),
        ...palette.entries.filter((e) => e.kind === "workflow").map((e) => e.id),
      ]),
      name.trim() || "Tour",
    );
    saveDraft(
      fresh,
      tourText(
        {
          name: fresh,
          stops,
          travel: travelling,
          present: presenting,
          waitForVisitor: wait,
          stayNear: near,
          speak,
        },
        props.names.prefixes,
      ),
      "",
    );
    props.onMade();
    navigate(paths.compose(fresh));
  };
  return (
    <>
      <header className="properties-head">
        <span className="hall-icon booth">
          <Route size={15} />
        </span>
        <span className="grow" style={{ fontWeight: 600, fontSize: "var(--text-l)" }}>
          New tour
        </span>
        <button className="button plain icon small" aria-label="Close" onClick={props.onClose}>
          <X size={15} />
        </button>
      </header>
      <div className="hall-details" tabIndex={0} aria-label="Tour">
        {stops.length === 0 ? (
          <p className="quiet">Click booths on the map, in the order of the tour.</p>
        ) : (
          <ol className="tour-stops">
            {stops.map((s, i) => (
              <li key={`${s.iri} ${i}`}>
                <span className="tour-number number">{i + 1}</span>
                <button
                  className="tour-stop grow cut"
                  aria-expanded={opened === i}
                  title="What is shown and said here"
                  onClick={() => setOpened(opened === i ? -1 : i)}
                >
                  {opened === i ? <ChevronDown size={13} /> : <ChevronRight size={13} />}
                  <span className="cut">{s.name}</span>
                  {(s.say?.trim() || s.present) && (
                    <span className="faint small cut">{s.say?.trim() ? `“${s.say.trim()}”` : "its own"}</span>
                  )}
                </button>
                <button
                  className="button plain icon small"
                  aria-label={`${s.name} earlier`}
                  disabled={i === 0}
                  onClick={() => move(i, -1)}
                >
                  <ArrowUp size={13} />
                </button>
                <button
                  className="button plain icon small"
                  aria-label={`${s.name} later`}
                  disabled={i === stops.length - 1}
                  onClick={() => move(i, 1)}
                >
                  <ArrowDown size={13} />
                </button>
                <button
                  className="button plain icon small"
                  aria-label={`Leave ${s.name} out`}
                  onClick={() => (setOpened(-1), set({ stops: stops.filter((_, k) => k !== i) }))}
                >
                  <X size={13} />
                </button>
                {opened === i && (
                  <div className="tour-own">
                    {speak && (
                      <label className="property">
                        <span>Say here</span>
                        <textarea
                          className="field"
                          rows={2}
                          value={s.say ?? ""}
                          placeholder="what the robot says before the rest"
                          onChange={(e) => change(i, { say: e.target.value })}
                        />
                      </label>
                    )}
                    {choices.map((e) => {
                      const own = s.present ?? presenting;
                      return (
                        <label key={e.id} className="row">
                          <input
                            type="checkbox"
                            checked={own.includes(e.id)}
                            onChange={(x) =>
                              change(i, {
                                present: x.target.checked ? [...own, e.id] : own.filter((p) => p !== e.id),
                              })
                            }
                          />
                          {e.title}
                        </label>
                      );
                    })}
                  </div>
                )}
              </li>
            ))}
          </ol>
        )}
        {stops.length > 0 && (
          <p className="quiet">
            About <b className="number">{Math.max(1, Math.round(minutes))} min</b>, by{" "}
            {routed ? "the routes of the hall" : "straight lines"} and {presentS} s at each stop.
          </p>
        )}
        <label className="property">
          <span>Name</span>
          <input className="field" value={name} onChange={(e) => set({ name: e.target.value })} />
        </label>
        <label className="property">
          <span>The robot drives by</span>
          <select className="field" value={travelling} onChange={(e) => set({ travel: e.target.value })}>
            {[...new Set([travelling, ...ways.map((e) => e.id)])].filter(Boolean).map((id) => (
              <option key={id} value={id}>
                {ways.find((e) => e.id === id)?.title ?? id}
              </option>
            ))}
          </select>
        </label>
        <fieldset className="tour-present">
          <legend className="quiet small">At each booth</legend>
          {choices.map((e) => (
            <label key={e.id} className="row">
              <input
                type="checkbox"
                checked={presenting.includes(e.id)}
                onChange={(x) =>
                  set({
                    present: x.target.checked ? [...presenting, e.id] : presenting.filter((p) => p !== e.id),
                  })
                }
              />
              {e.title}
            </label>
          ))}
        </fieldset>
        <label className="row">
          <input type="checkbox" checked={wait} onChange={(e) => set({ wait: e.target.checked })} />
          Wait until the visitor is there
        </label>
        <label className="row" title="Who falls behind is waited for: docent:isNear has to hold">
          <input type="checkbox" checked={near} onChange={(e) => set({ near: e.target.checked })} />
          Drive only while the visitor is near
        </label>
        <button className="button primary" disabled={stops.length === 0 || !travelling} onClick={make}>
          <Route size={14} />
          Make the workflow
        </button>
        {offers.length === 0 && (
          <p className="faint small">
            {palette.error
              ? palette.error.title
              : "No operation is known yet: start a robot, or register services."}
          </p>
        )}
      </div>
    </>
  );
}
