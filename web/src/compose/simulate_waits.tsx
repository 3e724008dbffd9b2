// What a simulation waits for at its end, and the form that tells a fact in it.
import { ChevronRight, Hourglass, Megaphone } from "lucide-react";
import { useState } from "react";
import type { Names } from "../api/prefixes";
import type { SimulatedWait, SimulateReply } from "../gen/docent/v1/replays_pb";
import { FactFields, quadOfRow } from "../facts/tell";
import type { Telling } from "./simulation";
import { activatorNode, classesIn, clockWords, type Lack, lacksOf, plainIris } from "./simulation_words";

const nothing = ["", "", ""];

interface TellProps {
  atS: number;
  names: Names;
  onTell: (telling: Telling) => void;
}

export function SimulateWaits({ reply, ...props }: TellProps & { reply: SimulateReply }) {
  const waits = reply.waits.filter((w) => w.node !== activatorNode);
  if (waits.length === 0 && !reply.pending) return null;
  return (
    <section className="simulate-part" aria-label="What is missing">
      <h2 className="row">
        <Hourglass size={13} />
        It ends waiting
      </h2>
      {waits.map((wait) => (
        <Wait key={`${wait.node} ${wait.waitsFor}`} wait={wait} {...props} />
      ))}
      {reply.pending && <p>{plainIris(reply.pending)}</p>}
    </section>
  );
}

function Wait({ wait, ...props }: TellProps & { wait: SimulatedWait }) {
  const classes = classesIn(wait.waitsFor);
  const lacks = lacksOf(wait.missing, props.names);
  return (
    <div className="simulate-wait">
      <p>
        <b>{wait.node}</b> {lacks.length > 0 ? "waits for" : "waits"}
      </p>
      {lacks.map((lack) => (
        <LackRow key={lack.text} lack={lack} classes={classes} {...props} />
      ))}
    </div>
  );
}

// A fact with a variable in it has to be completed first.
function LackRow({
  lack,
  classes,
  ...props
}: TellProps & { lack: Lack; classes: ReadonlyMap<string, string> }) {
  const [open, setOpen] = useState(false);
  const words = (
    <code>
      {lack.remove && "not "}
      {lack.text}
    </code>
  );
  if (!lack.row)
    return (
      <p className="lack-words">
        <ChevronRight size={12} />
        {plainIris(lack.text)}
      </p>
    );
  const row = lack.row;
  return (
    <>
      <div className="simulate-lack">
        <ChevronRight size={12} />
        <span className="grow">{words}</span>
        {!open && (
          <button
            className="button small"
            onClick={() =>
              lack.open
                ? setOpen(true)
                : props.onTell({
                    afterS: props.atS,
                    quad: quadOfRow(row, props.names.prefixes),
                    remove: lack.remove,
                  })
            }
          >
            Tell it at {clockWords(props.atS)}
          </button>
        )}
      </div>
      {open && (
        <TellForm
          {...props}
          focused
          first={row.map((word) => (word.startsWith("?") ? "" : word))}
          classes={row.map((word) => classes.get(word.slice(1)))}
          remove={lack.remove}
        />
      )}
    </>
  );
}

export function TellForm({
  atS,
  names,
  onTell,
  first = nothing,
  classes,
  remove = false,
  focused = false,
}: TellProps & {
  first?: readonly string[];
  focused?: boolean;
  classes?: readonly (string | undefined)[];
  remove?: boolean;
}) {
  const [row, setRow] = useState(first);
  const [error, setError] = useState("");
  const tell = () => {
    try {
      onTell({ afterS: atS, quad: quadOfRow(row, names.prefixes), remove });
      setRow(first);
      setError("");
    } catch (failure) {
      if (!(failure instanceof RangeError)) throw failure;
      setError(failure.message);
    }
  };
  return (
    <form className="simulate-tell" onSubmit={(e) => (e.preventDefault(), tell())}>
      <FactFields
        row={row}
        names={names}
        {...(classes && { classes })}
        {...(focused && { focused: first.indexOf("") })}
        onChange={setRow}
      />
      <button className="button small" type="submit" disabled={row.some((word) => word.trim() === "")}>
        <Megaphone size={12} />
        Tell it at {clockWords(atS)}
      </button>
      {error && (
        <p className="notice bad" role="alert">
          {error}
        </p>
      )}
    </form>
  );
}
