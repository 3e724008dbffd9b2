// A step on the canvas: what it does, what opens it, and what is wrong with it.
import { Handle, Position, type Node, type NodeProps } from "@xyflow/react";
import {
  Ban,
  Bot,
  CircleAlert,
  Clock3,
  Flag,
  GitCompareArrows,
  Play,
  Repeat2,
  RotateCw,
  TriangleAlert,
  Unlink,
  Workflow,
  Wrench,
  Zap,
} from "lucide-react";
import { memo } from "react";
import type { Step } from "../cawl/document";
import { conditionLogic } from "../cawl/condition_logic";
import { words } from "../cawl/names";
import { conditionRows, logicWords } from "../cawl/phrases";

export interface StepData extends Record<string, unknown> {
  step: Step & { stale: boolean };
  errors: number;
  warnings: number;
  serviceNames: ReadonlySet<string>; // which operations are services
  state?: string; // of a run
  stateLabel?: string;
  differs?: string; // in words: a past run would go otherwise here
  breakpoint?: boolean;
  onBreakpoint?: (step: string) => void; // absent: it can have none here
}
export type StepNode = Node<StepData, "step">;

export const StepCard = memo(function StepCard({ data, selected, isConnectable }: NodeProps<StepNode>) {
  const { step } = data;
  // Not "source" and "sink": the canvas takes what has the class "source" for a handle.
  const shape = step.kind === "node" ? "node" : step.kind === "source" ? "begin" : "end";
  const classes = `step ${shape}${selected ? " selected" : ""}${step.stale ? " unmended" : ""}${data.state ? ` run-${data.state}` : ""}`;
  const handles = (
    <>
      {step.kind !== "source" && (
        <Handle type="target" position={Position.Top} isConnectable={isConnectable && !step.stale} />
      )}
      {step.kind !== "sink" && (
        <Handle type="source" position={Position.Bottom} isConnectable={isConnectable && !step.stale} />
      )}
    </>
  );
  if (step.kind !== "node")
    return (
      <div className="step-slot">
        <div className={classes}>
          {step.kind === "source" ? <Play size={13} /> : <Flag size={13} />}
          <span className="cut">{step.name || "(no name)"}</span>
          <Marks errors={data.errors} warnings={data.warnings} />
          {handles}
        </div>
      </div>
    );
  const rows = step.condition ? conditionRows(step.condition) : [];
  return (
    <div className={classes}>
      <header>
        {data.onBreakpoint && !step.stale && (
          <button
            className="step-breakpoint nodrag"
            tabIndex={-1}
            aria-pressed={data.breakpoint ?? false}
            aria-label={`Breakpoint at ${step.name}`}
            title={data.breakpoint ? "Breakpoint: a simulation stops here (B)" : "Set a breakpoint (B)"}
            onClick={(e) => (e.stopPropagation(), data.onBreakpoint?.(step.name))}
            onDoubleClick={(e) => e.stopPropagation()}
          >
            <span />
          </button>
        )}
        <span className="cut" title={step.documentation || undefined}>
          {step.name || "(no name)"}
        </span>
        {data.stateLabel && <span className={`state-chip ${data.state}`}>{data.stateLabel}</span>}
        {data.differs && (
          <span className="step-differs" title={data.differs}>
            <GitCompareArrows size={12} aria-hidden />
            differs
          </span>
        )}
        {step.forEach && (
          <span className="step-mark" title={`Once for each ${step.forEach}`}>
            <Repeat2 size={13} />
          </span>
        )}
        {step.retry && (
          <span className="step-mark" title={`Tried again ${step.retry} times`}>
            <RotateCw size={12} />
          </span>
        )}
        {step.timeout && (
          <span className="step-mark" title={`Ends after ${step.timeout}`}>
            <Clock3 size={12} />
            {step.timeout}
          </span>
        )}
        {step.stale && (
          <span className="step-mark" title="From the last text without mistakes">
            <Unlink size={12} />
          </span>
        )}
        <Marks errors={data.errors} warnings={data.warnings} />
      </header>
      {rows.length > 0 && (
        <ul className="step-condition" aria-label="Opens when">
          {rows.slice(0, 2).map((row, i) => (
            <li key={i} title={row.words}>
              {row.isNot ? <Ban size={11} aria-hidden /> : <Zap size={11} aria-hidden />}
              <span className="cut">{row.words}</span>
            </li>
          ))}
          {rows.length > 2 && (
            <li className="faint">
              <span className="step-more">and {rows.length - 2} more</span>
            </li>
          )}
        </ul>
      )}
      {step.invokes.length > 0 && (
        <ul className="step-invokes">
          {step.invokes.slice(0, 3).map((invoke, i) => {
            const kind =
              invoke.kind === "subflow"
                ? "workflow"
                : data.serviceNames.has(invoke.target)
                  ? "service"
                  : "operation";
            return (
              <li key={i} className={kind}>
                <KindIcon kind={kind} size={13} />
                <span className="cut">{words(invoke.target) || "nothing yet"}</span>
              </li>
            );
          })}
        </ul>
      )}
      {handles}
    </div>
  );
});

export function KindIcon({
  kind,
  size = 15,
}: {
  kind: "operation" | "service" | "workflow" | "empty";
  size?: number;
}) {
  const Icon =
    kind === "workflow" ? Workflow : kind === "service" ? Wrench : kind === "operation" ? Bot : Play;
  return <Icon size={size} className={`kind-${kind}`} aria-hidden />;
}

function Marks({ errors, warnings }: { errors: number; warnings: number }) {
  if (errors > 0)
    return (
      <span className="step-badge bad" title={`${errors} to mend`}>
        <CircleAlert size={13} />
        {errors}
      </span>
    );
  if (warnings > 0)
    return (
      <span className="step-badge wait" title={`${warnings} to look at`}>
        <TriangleAlert size={13} />
        {warnings}
      </span>
    );
  return null;
}

// What a screen reader says of a step.
export function stepWords(data: StepData): string {
  const { step } = data;
  if (step.kind !== "node") return `${step.kind === "source" ? "Begin" : "End"}: ${step.name}`;
  const does = step.invokes.map((i) => words(i.target)).join(", ");
  const opens = step.condition ? logicWords(conditionLogic(step.condition)) : "";
  return [
    `Step ${step.name}`,
    does && `does ${does}`,
    opens && `opens when ${opens}`,
    data.breakpoint && "breakpoint",
    data.stateLabel,
    data.differs,
    data.errors > 0 && `${data.errors} to mend`,
  ]
    .filter(Boolean)
    .join("; ");
}
