// The playhead of a simulation as controls: back, play, next, the clock and its slider, the speed.
import { Pause, Play, SkipBack, SkipForward } from "lucide-react";
import { type Player, speeds } from "./playing";
import type { SimulationEvent } from "./simulation";
import { clockWords } from "./simulation_words";

const ticksPerS = 10;

export function SimulatePlayer({
  player,
  events,
  lengthS,
}: {
  player: Player;
  events: readonly SimulationEvent[];
  lengthS: number;
}) {
  const { head } = player;
  const share = (afterS: number) => `${(afterS / (lengthS || 1)) * 100}%`;
  return (
    <>
      <button
        className="button plain icon small"
        aria-label="Back"
        title="Back (←)"
        disabled={head.done === 0}
        onClick={() => player.toEvent(head.done - 1)}
      >
        <SkipBack size={14} />
      </button>
      <button
        className="button icon small"
        aria-label={player.playing ? "Pause" : "Play"}
        title={player.playing ? "Pause (Space)" : "Play (Space)"}
        onClick={player.playing ? player.pause : player.play}
      >
        {player.playing ? <Pause size={14} /> : <Play size={14} />}
      </button>
      <button
        className="button plain icon small"
        aria-label="Next step"
        title="Next step (→)"
        disabled={head.done >= events.length}
        onClick={() => player.toEvent(head.done + 1)}
      >
        <SkipForward size={14} />
      </button>
      <div className="time-track">
        <div className="time-marks" aria-hidden>
          {events.map((e, i) => (
            <span key={i} className={e.telling ? "told" : ""} style={{ left: share(e.afterS) }} />
          ))}
        </div>
        <input
          type="range"
          aria-label="Simulated time"
          aria-valuetext={clockWords(head.afterS)}
          min={0}
          max={Math.ceil(lengthS * ticksPerS)}
          step={1}
          value={Math.round(head.afterS * ticksPerS)}
          onChange={(e) => player.seek(Math.min(lengthS, Number(e.target.value) / ticksPerS))}
        />
      </div>
      <span className="number simulate-clock" role="timer" aria-label="Simulated clock">
        {clockWords(head.afterS)}
        <span className="faint"> / {clockWords(lengthS)}</span>
      </span>
      <select
        className="field small simulate-speed"
        aria-label="Speed of playing"
        value={player.speed}
        onChange={(e) => player.setSpeed(Number(e.target.value))}
      >
        {speeds.map((s) => (
          <option key={s} value={s}>
            {s}×
          </option>
        ))}
      </select>
    </>
  );
}

// Space plays, arrows go from event to event, where the focus is in the panel and not in a field.
export function playerKeys(player: Player) {
  return (event: React.KeyboardEvent) => {
    const target = event.target instanceof HTMLElement ? event.target : null;
    const range = target instanceof HTMLInputElement && target.type === "range";
    if (
      event.ctrlKey ||
      event.metaKey ||
      event.altKey ||
      event.shiftKey ||
      (!range && target?.matches("input, select, textarea"))
    )
      return;
    if (event.key === " " && !target?.matches("button")) (player.playing ? player.pause : player.play)();
    else if (event.key === "ArrowRight" && !range) player.toEvent(player.head.done + 1);
    else if (event.key === "ArrowLeft" && !range) player.toEvent(player.head.done - 1);
    else return;
    event.preventDefault();
  };
}
