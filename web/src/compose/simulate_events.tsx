// What happened in a simulation, in order: what is past stands out, and the list goes along with the clock.
import { X } from "lucide-react";
import { memo, type RefObject, useEffect, useRef } from "react";
import type { Names } from "../api/prefixes";
import type { SimulationEvent, Telling } from "./simulation";
import { clockWords, eventWords } from "./simulation_words";

interface EventsProps {
  events: readonly SimulationEvent[];
  done: number;
  names: Names;
  onEvent: (done: number) => void;
  onTakeBack: (telling: Telling) => void;
}

export function SimulateEvents(props: EventsProps) {
  const latest = useRef(props);
  latest.current = props;
  return <List events={props.events} done={props.done} names={props.names} latest={latest} />;
}

// Drawn when something has happened, and not with each tick of the clock.
const List = memo(function List({
  events,
  done,
  names,
  latest,
}: Pick<EventsProps, "events" | "done" | "names"> & { latest: RefObject<EventsProps> }) {
  const list = useRef<HTMLOListElement>(null);
  useEffect(() => {
    const row = list.current?.children[Math.max(0, done - 1)];
    if (!(row instanceof HTMLElement) || !list.current) return;
    list.current.scrollTop = row.offsetTop - list.current.offsetTop - list.current.clientHeight / 2; // the list alone, not the page
  }, [done, events]);
  return (
    <ol className="simulate-events" ref={list} tabIndex={0} aria-label="What happens">
      {events.map((event, i) => {
        const { who, what, why } = eventWords(event, names);
        return (
          <li key={i} className={i < done ? "" : "to-come"} aria-current={i === done - 1}>
            <button className="simulate-event" title={why} onClick={() => latest.current.onEvent(i + 1)}>
              <span className="number faint">{clockWords(event.afterS)}</span>
              <span>
                {who && <b>{who}</b>}
                {who && ": "}
                {what}
                {why && <span className="faint"> {why}</span>}
              </span>
            </button>
            {event.telling && (
              <button
                className="button plain icon small"
                aria-label={`Take back: ${what}`}
                title="Take it back"
                onClick={() => event.telling && latest.current.onTakeBack(event.telling)}
              >
                <X size={13} />
              </button>
            )}
          </li>
        );
      })}
    </ol>
  );
});
