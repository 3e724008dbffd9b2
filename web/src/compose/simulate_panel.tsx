// "Simulate" below the canvas: the text as it is now, deployed or not, runs with simulated robots; what happens is played.
import {
  ChevronDown,
  ChevronUp,
  CircleAlert,
  CirclePause,
  FlaskConical,
  LoaderCircle,
  SlidersHorizontal,
  StepForward,
} from "lucide-react";
import { useEffect, useMemo, useRef, useState } from "react";
import type { Names } from "../api/prefixes";
import { shorten } from "../api/sparql";
import type { StartVariable } from "../cawl/start_values";
import { StartFields } from "../flow/start_dialog";
import { StateTag } from "../ui/states";
import type { ShownFlow } from "../cawl/shown";
import type { Findings } from "./findings";
import { usePlayer } from "./playing";
import { SimulateEvents } from "./simulate_events";
import { SimulateHall } from "./simulate_hall";
import { playerKeys, SimulatePlayer } from "./simulate_player";
import { SimulateWaits, TellForm } from "./simulate_waits";
import {
  commandsAfter,
  endOf,
  eventsOf,
  hasEnded,
  type SimulationEvent,
  statesAt,
  stopsOf,
  valuesAt,
} from "./simulation";
import { activatorNode, commandWords, lacksOf, noteWords, plainIris } from "./simulation_words";
import { type Simulations, useSimulation } from "./simulations";
import type { StepTrial } from "./trials";
import type { Vocabulary } from "../facts/vocabulary";
import "../ui/time_bar.css";
import "./simulate.css";

export interface SimulatePanelProps {
  workflow: string;
  text: string;
  shown: ShownFlow;
  variables: readonly StartVariable[];
  findings: Findings;
  breakpoints: ReadonlySet<string>;
  names: Names;
  prefixes: ReadonlyMap<string, string>; // of the document
  vocabulary: Vocabulary;
  open: boolean;
  onToggle: () => void;
  onStates: (states: ReadonlyMap<string, StepTrial> | null) => void; // of steps, for the canvas
}
const none: readonly SimulationEvent[] = [];

export function SimulatePanel(props: SimulatePanelProps) {
  const { shown, breakpoints, open, onStates } = props;
  const names = useMemo(() => {
    const prefixes = new Map([...props.names.prefixes, ...props.prefixes]);
    return { ...props.names, prefixes, short: (iri: string) => shorten(iri, prefixes) };
  }, [props.names, props.prefixes]);
  const simulation = useSimulation(
    props.workflow,
    props.text,
    shown.flow.name,
    props.findings,
    names.prefixes,
  );
  const result = simulation.shown;
  const events = useMemo(() => (result ? eventsOf(result.reply, result.told) : none), [result]);
  const end = useMemo(
    () => (result ? endOf(result.reply, events) : { endS: 0, lengthS: 0 }),
    [result, events],
  );
  const stops = useMemo(() => stopsOf(events, breakpoints), [events, breakpoints]);
  const player = usePlayer(events, end, stops);
  const { head } = player;
  const ofFlow = result?.flow === shown.flow.name;
  const states = useMemo(
    () => (open && ofFlow ? statesAt(events, head.done, shown.steps) : null),
    [open, ofFlow, events, head.done, shown.steps],
  );
  useEffect(() => onStates(states), [states, onStates]);
  const box = useRef<HTMLDivElement>(null);
  useEffect(() => void (open && box.current?.querySelector("button")?.focus()), [open]);
  const begin = () => void simulation.simulate().then((done) => done && player.playFromBegin());
  return (
    <section
      className="findings"
      aria-label="Simulate"
      onKeyDown={open && result ? playerKeys(player) : undefined}
    >
      <button className="findings-bar" aria-expanded={open} onClick={props.onToggle}>
        <FlaskConical size={14} />
        <span>Simulate</span>
        {result && <StateTag state={result.reply.state === "running" ? "waiting" : result.reply.state} />}
        {simulation.old && <span className="faint">before the edit</span>}
        <span className="grow" />
        {open ? <ChevronDown size={14} /> : <ChevronUp size={14} />}
      </button>
      {open && (
        <div className="simulate" ref={box}>
          <div className="simulate-top">
            <button
              className="button small primary simulate-begin"
              disabled={simulation.faulty}
              onClick={begin}
            >
              {simulation.busy ? <LoaderCircle size={13} className="turn" /> : <FlaskConical size={13} />}
              {simulation.old ? "Simulate again" : "Simulate"}
            </button>
            <StartValues simulation={simulation} variables={props.variables} vocabulary={props.vocabulary} />
            {result && <SimulatePlayer player={player} events={events} lengthS={end.lengthS} />}
          </div>
          {simulation.faulty && (
            <p className="notice bad">
              <CircleAlert size={14} />
              The text has errors. Mend them first; then it can be simulated.
            </p>
          )}
          {simulation.error && (
            <p className="notice bad" role="alert">
              <CircleAlert size={14} />
              {simulation.error}
            </p>
          )}
          {simulation.old && (
            <p className="notice wait">
              <CircleAlert size={14} />
              What is shown was simulated before the edit
              {simulation.faulty ? "." : "; it is simulated again in a moment."}
            </p>
          )}
          {!result && (
            <p className="faint">
              The workflow runs with simulated robots, on the facts of now. No robot gets anything, and the
              real graph stays as it is.
            </p>
          )}
          {result && (
            <div className="simulate-body">
              <SimulateEvents
                events={events}
                done={head.done}
                names={names}
                onEvent={player.toEvent}
                onTakeBack={simulation.untell}
              />
              <div className="simulate-side" tabIndex={0} aria-label="State of the simulation">
                {player.stop >= 0 && (
                  <Stopped
                    events={events}
                    done={head.done}
                    stop={player.stop}
                    given={result.values}
                    names={names}
                    onGoOn={player.play}
                  />
                )}
                {head.afterS >= end.endS && result.reply.reason && (
                  <p className="notice bad">
                    <CircleAlert size={14} />
                    {plainIris(result.reply.reason)}
                  </p>
                )}
                {head.afterS >= end.endS && !hasEnded(result.reply) && (
                  <SimulateWaits
                    reply={result.reply}
                    atS={head.afterS}
                    names={names}
                    onTell={simulation.tell}
                  />
                )}
                {result.reply.stopped && (
                  <p className="notice wait">
                    <CircleAlert size={14} />
                    {noteWords(result.reply.stopped)}
                  </p>
                )}
                {result.reply.poses.length > 0 && (
                  <SimulateHall poses={result.reply.poses} atS={head.afterS} />
                )}
                <section className="simulate-part" aria-label="Tell a fact">
                  <h2>Tell a fact</h2>
                  <p className="faint">
                    It is known in the simulation alone; nothing reaches the real graph.
                  </p>
                  <TellForm atS={head.afterS} names={names} onTell={simulation.tell} />
                </section>
                <Notes simulation={simulation} names={names} />
              </div>
            </div>
          )}
        </div>
      )}
    </section>
  );
}

function StartValues({
  simulation,
  variables,
  vocabulary,
}: {
  simulation: Simulations;
  variables: readonly StartVariable[];
  vocabulary: Vocabulary;
}) {
  const [open, setOpen] = useState(false);
  if (variables.length === 0) return null;
  const given = variables.filter((v) => simulation.values[v.name]?.trim()).length;
  return (
    <>
      <button
        className="button small"
        aria-expanded={open}
        aria-label="Start values"
        title="Start values"
        onClick={() => setOpen(!open)}
      >
        <SlidersHorizontal size={13} />
        <span className="simulate-values-words">Start values</span>
        {given > 0 && <span>({given})</span>}
      </button>
      {open && (
        <div className="simulate-values">
          <p className="faint">
            Optional: what the activator does not give. They count from the next simulation on.
          </p>
          <StartFields
            variables={variables}
            values={simulation.values}
            vocabulary={vocabulary}
            onChange={simulation.setValues}
          />
        </div>
      )}
    </>
  );
}

function Stopped(props: {
  events: readonly SimulationEvent[];
  done: number;
  stop: number;
  given: Readonly<Record<string, string>>;
  names: Names;
  onGoOn: () => void;
}) {
  const { events, done } = props;
  const at = events[props.stop]?.step;
  const values = [
    ...new Map([
      ...Object.entries(props.given).filter(([, written]) => written.trim() !== ""),
      ...valuesAt(events, done),
    ]),
  ];
  return (
    <div className="notice simulate-stopped" role="status">
      <div className="row">
        <CirclePause size={14} />
        <b className="grow">Stopped at {at?.node}</b>
        <button className="button small" onClick={props.onGoOn}>
          <StepForward size={13} />
          Go on
        </button>
      </div>
      <p>The step {at?.step?.state === "waiting" ? "comes to wait, and does not open" : "opens"}.</p>
      {values.length > 0 && (
        <p>
          Values so far:{" "}
          <code>
            {values
              .map(
                ([name, value]) =>
                  `${name} = ${value.replace(/^<(.*)>$/, (whole, iri: string) => props.names.short(iri) || whole)}`,
              )
              .join(", ")}
          </code>
        </p>
      )}
      {commandsAfter(events, done, at?.node ?? "").map((command, i) => (
        <p key={i}>Next, {commandWords(command, "would get")}.</p>
      ))}
    </div>
  );
}

function Notes({ simulation, names }: { simulation: Simulations; names: Names }) {
  const reply = simulation.shown?.reply;
  if (!reply || reply.notes.length === 0) return null;
  const lacks = reply.waits
    .filter((w) => w.node === activatorNode)
    .flatMap((w) => lacksOf(w.missing, names))
    .filter((lack) => lack.row);
  return (
    <section className="simulate-part" aria-label="What was assumed">
      <h2>What was assumed</h2>
      <ul className="faint">
        {reply.notes.map((note) => (
          <li key={note}>{noteWords(note)}</li>
        ))}
        {lacks.length > 0 && (
          <li>
            To start it waits for{" "}
            {lacks.map((lack) => (
              <code key={lack.text}>{lack.text} </code>
            ))}
          </li>
        )}
      </ul>
    </section>
  );
}
