// The time that hall, runs and facts show: live, or any time that the log still has. Below the views that can show the past.
import { CircleAlert, Pause, Play, Radio, SkipBack, SkipForward, Unplug } from "lucide-react";
import { useEffect, useEffectEvent, useState } from "react";
import { useAsOf } from "../api/as_of";
import { useConnection } from "../api/connection";
import { query } from "../api/sparql";
import { useCommands } from "../ui/commands";
import { serverNow, showTime, usePast } from "../api/past";
import { announce } from "../ui/toasts";
import { nextMark, spans, useMarks, usualSpan } from "./marks";
import { useTicks } from "./runs";
import { clock, duration, timeTitle } from "../ui/states";
import "../ui/time_bar.css";

const speeds = [1, 4, 16] as const;
const frameMs = 200;
const steps = 400; // places of the slider
const liveMs = 400; // so near the right end it is live

const micros = (ms: number) => BigInt(Math.round(ms)) * 1000n;

// `run`: the slider spans this run.
export default function TimeBar({ run }: { run: string }) {
  const at = usePast();
  const polled = useMarks();
  useTicks(at === null ? 500 : 5000);
  const now = serverNow();
  const all = polled.data ?? [];
  const marks = run ? all.filter((m) => m.run === run) : all;
  const [chosenSpan, setSpan] = useState(0);
  const [frozen, setFrozen] = useState<{ from: number; to: number } | null>(null);
  const [speed, setSpeed] = useState<number>(4);
  const [playing, setPlaying] = useState(false);
  const span = chosenSpan || usualSpan(marks, now);
  const ended = run ? marks.findLast((m) => m.ends)?.ms : undefined;
  const live =
    run && marks[0]
      ? { from: marks[0].ms - 1000, to: ended === undefined ? now : ended + 1000 }
      : { from: now - span, to: now };
  // In the past the ends stand still, so that the slider does not run away below the finger.
  const still = at !== null && polled.data !== undefined;
  const freeze = useEffectEvent(() => setFrozen(still ? (before) => before ?? live : null));
  useEffect(() => freeze(), [still, span, run]);
  const range = frozen ?? live;
  const from = at !== null && at < range.from ? at : range.from;
  const to = Math.max(range.to, at ?? 0);

  const go = (ms: number | null) => {
    if (ms === null) setPlaying(false);
    showTime(ms);
  };
  const jump = (direction: 1 | -1) => {
    const mark = nextMark(marks, at ?? now, direction);
    setPlaying(false);
    if (mark) {
      go(mark.ms);
      announce(`${mark.words}, ${clock(micros(mark.ms))}`);
    } else if (direction > 0 && polled.data) go(null); // behind the last one; before they are known it stays
  };
  const frame = useEffectEvent(() => {
    const next = (at ?? from) + frameMs * speed;
    if (next < now && (ended === undefined || next <= ended + 1000)) return showTime(next);
    setPlaying(false);
    if (next >= now) showTime(null);
  });
  useEffect(() => {
    if (!playing) return;
    const timer = window.setInterval(() => frame(), frameMs);
    return () => window.clearInterval(timer);
  }, [playing, at, speed]);
  const play = () => {
    if (!playing && at === null) showTime(from);
    setPlaying(!playing);
  };
  useCommands([
    {
      title: "The event before",
      group: "Time",
      icon: SkipBack,
      keys: ",",
      words: "past history scrub",
      run: () => jump(-1),
    },
    {
      title: "The next event",
      group: "Time",
      icon: SkipForward,
      keys: ".",
      words: "past history scrub",
      run: () => jump(1),
    },
    {
      title: playing ? "Hold the time" : "Play the past",
      group: "Time",
      icon: playing ? Pause : Play,
      keys: "Shift+L",
      words: "replay history",
      run: play,
    },
    { title: "Back to live", group: "Time", icon: Radio, keys: "L", words: "now", run: () => go(null) },
  ]);
  const away = useConnection().state === "away";
  const here = at === null ? undefined : marks.findLast((m) => m.ms <= at + 1);
  const there = useAsOf("there", at, (asOf, signal) => query("ASK {}", signal, asOf));
  const words = at === null ? "live" : `${clock(micros(at))}, ${duration(micros(at), micros(now))} ago`;
  return (
    <section className={`time-bar${at === null ? "" : " past"}`} aria-label="Time">
      <button
        className="button plain icon small"
        aria-label="The event before"
        title="The event before ( , )"
        disabled={!nextMark(marks, at ?? now, -1)}
        onClick={() => jump(-1)}
      >
        <SkipBack size={14} />
      </button>
      <button
        className="button plain icon small"
        aria-label={playing ? "Hold the time" : "Play the past"}
        title="Play the past (Shift-L)"
        onClick={play}
      >
        {playing ? <Pause size={14} /> : <Play size={14} />}
      </button>
      <button
        className="button plain icon small"
        aria-label="The next event"
        title="The next event ( . )"
        disabled={at === null || !polled.data}
        onClick={() => jump(1)}
      >
        <SkipForward size={14} />
      </button>
      <div className="time-track">
        <div className="time-marks" aria-hidden>
          {marks
            .filter((m) => m.ms >= from && m.ms <= to)
            .map((m, i) => (
              <span
                key={i}
                className={m.ends ? "ends" : ""}
                title={m.words}
                style={{ left: `${((m.ms - from) / (to - from || 1)) * 100}%` }}
              />
            ))}
        </div>
        <input
          type="range"
          aria-label="Time that is shown"
          aria-valuetext={words}
          min={0}
          max={steps * 10}
          step={10}
          value={at === null ? steps * 10 : Math.round(((at - from) / (to - from || 1)) * steps * 10)}
          onChange={(e) => {
            setPlaying(false);
            const part = Number(e.target.value) / (steps * 10);
            const ms = from + part * (to - from);
            go(part >= 1 && now - ms < liveMs + span ? null : ms);
          }}
        />
      </div>
      <span
        className="time-words number"
        role="status"
        title={at === null ? undefined : timeTitle(micros(at))}
      >
        {at === null ? "" : words}
        {there.error ? (
          <span className="cut" title={there.error.detail}>
            <CircleAlert size={12} /> {there.error.detail}
          </span>
        ) : (
          here && <span className="faint cut">{here.words}</span>
        )}
      </span>
      <select
        className="field small time-speed wide-only"
        aria-label="Speed of playing"
        value={speed}
        onChange={(e) => setSpeed(Number(e.target.value))}
      >
        {speeds.map((s) => (
          <option key={s} value={s}>
            {s}×
          </option>
        ))}
      </select>
      {!run && (
        <select
          className="field small time-span wide-only"
          aria-label="How far back"
          value={span}
          onChange={(e) => (setSpan(Number(e.target.value)), setFrozen(null))}
        >
          {spans.map((s) => (
            <option key={s.ms} value={s.ms}>
              {s.words}
            </option>
          ))}
        </select>
      )}
      <button
        className={`button small time-live${at === null ? (away ? " away" : " on") : ""}`}
        aria-pressed={at === null}
        title={away ? "The server does not answer" : "Back to live (L)"}
        onClick={() => go(null)}
      >
        {away ? <Unplug size={13} /> : <Radio size={13} />}
        {away ? "Not live" : "Live"}
      </button>
    </section>
  );
}
