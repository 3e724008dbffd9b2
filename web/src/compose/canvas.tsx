// The canvas: the flow of the text as cards and arrows. What is done here becomes an edit of the text; only a drag that is under
// way, and what is selected, live here.
import {
  Background,
  BackgroundVariant,
  ConnectionMode,
  Controls,
  type EdgeChange,
  MarkerType,
  type NodeChange,
  type OnConnectEnd,
  ReactFlow,
  ReactFlowProvider,
  SelectionMode,
  getViewportForBounds,
  useReactFlow,
  applyNodeChanges,
} from "@xyflow/react";
import "@xyflow/react/dist/style.css";
import { useEffect, useMemo, useRef, useState, type ReactNode } from "react";
import { inFlowOrder, type ShownFlow } from "../cawl/shown";
import { placed, placeSteps, stepHeight, stepWidth } from "../cawl/placing";
import type { Actions, AddWhere, NewKind } from "./actions";
import type { Finding } from "./findings";
import { LinkEdge, type LinkEdgeType } from "../flow/link_edge";
import { look } from "../ui/states";
import { lessMotion } from "./playing";
import { useRefit, withPiece } from "../flow/refit";
import { StepCard, stepWords, type StepNode } from "../flow/step_card";
import type { StepTrial } from "./trials";
import "../flow/canvas.css";

export interface CanvasProps {
  shown: ShownFlow;
  findings: readonly Finding[];
  serviceNames: ReadonlySet<string>;
  selected: ReadonlySet<string>; // keys of steps
  selectedLinks: ReadonlySet<string>;
  refreshed: number;
  trial: ReadonlyMap<string, StepTrial> | null; // how a past run would go, or a simulation stands, by the names of steps
  breakpoints: ReadonlySet<string>; // names of steps
  onBreakpoint: (step: string) => void;
  actions: Actions;
  onSelect: (steps: string[], links: string[]) => void;
  onQuickAdd: (where: AddWhere) => void;
  onOpen: (key: string) => void;
  children?: ReactNode;
}

const nodeTypes = { step: StepCard };
const edgeTypes = { link: LinkEdge };
const readable = 0.8; // of a card's full size
const smallest = 0.5;
export const dragType = "application/x-docent-step";
// What is dragged out of the palette now; the browser does not tell during a drag.
export const dragged: { what: NewKind | null } = { what: null };

export function Canvas(props: CanvasProps) {
  return (
    <ReactFlowProvider>
      <Flow {...props} />
    </ReactFlowProvider>
  );
}

function useNodes(props: CanvasProps): StepNode[] {
  const { shown, findings, serviceNames, selected, trial, breakpoints, onBreakpoint } = props;
  const order = useMemo(() => inFlowOrder(shown.steps, shown.links), [shown]);
  const places = useMemo(() => placeSteps(shown.steps, shown.links), [shown]);
  return useMemo(() => {
    const counts = new Map<string, { errors: number; warnings: number }>();
    for (const f of findings) {
      if (f.flow !== shown.flow.key || !f.step) continue;
      const count = counts.get(f.step) ?? { errors: 0, warnings: 0 };
      counts.set(
        f.step,
        f.error ? { ...count, errors: count.errors + 1 } : { ...count, warnings: count.warnings + 1 },
      );
    }
    return order.map((step): StepNode => {
      const { errors, warnings } = counts.get(step.key) ?? { errors: 0, warnings: 0 };
      const tried = trial?.get(step.name);
      const data = {
        step,
        serviceNames,
        errors,
        warnings,
        breakpoint: breakpoints.has(step.name),
        onBreakpoint,
        ...(tried && { state: tried.state, stateLabel: look(tried.state).words }),
        ...(tried?.differs && { differs: "the past run would differ here" }),
      };
      return {
        id: step.key,
        type: "step",
        data,
        position: places.get(step.key) ?? { x: 0, y: 0 },
        selected: selected.has(step.key),
        width: stepWidth,
        height: stepHeight(step),
        measured: { width: stepWidth, height: stepHeight(step) },
        deletable: !step.stale,
        draggable: !step.stale,
        ariaLabel: stepWords(data),
      };
    });
  }, [order, places, findings, serviceNames, selected, shown, trial, breakpoints, onBreakpoint]);
}

function Flow(props: CanvasProps) {
  const { shown, actions, selectedLinks, onQuickAdd } = props;
  const flow = useReactFlow<StepNode, LinkEdgeType>();
  const fromModel = useNodes(props);
  const [nodes, setNodes] = useState(fromModel);
  const [hovered, setHovered] = useState<string | null>(null);
  const [calm, setCalm] = useState(false);
  const moved = useRef<Set<string>>(new Set());
  const timer = useRef(0);
  const pane = useRef<HTMLDivElement>(null);

  // What is being moved keeps its place, whatever else changes meanwhile.
  useEffect(() => {
    setNodes((before) => {
      if (moved.current.size === 0) return fromModel;
      const now = new Map(before.map((node) => [node.id, node]));
      return fromModel.map((node) => {
        const moving = moved.current.has(node.id) ? now.get(node.id) : undefined;
        return moving
          ? {
              ...node,
              position: moving.position,
              ...(moving.dragging !== undefined && { dragging: moving.dragging }),
            }
          : node;
      });
    });
  }, [fromModel]);

  // A layout that is not by hand may change with each edit: the cards glide there, so that the eye can follow.
  const signature = nodes.length;
  useEffect(() => {
    setCalm(true);
    const t = window.setTimeout(() => setCalm(false), 260);
    return () => window.clearTimeout(t);
  }, [signature, props.refreshed]);
  const [asked] = useState(() => (props.selected.size === 1 ? ([...props.selected][0] ?? "") : "")); // the step of the address
  // The whole flow in view, by the places that the model has: the canvas may not have drawn them yet.
  const show = (largest: number) => {
    const box = pane.current?.getBoundingClientRect();
    if (!box || box.width === 0 || fromModel.length === 0) return;
    const left = Math.min(...fromModel.map((n) => n.position.x));
    const top = Math.min(...fromModel.map((n) => n.position.y));
    const bounds = {
      x: left,
      y: top,
      width: Math.max(...fromModel.map((n) => n.position.x + (n.width ?? 0))) - left,
      height: Math.max(...fromModel.map((n) => n.position.y + (n.height ?? 0))) - top,
    };
    const view = getViewportForBounds(bounds, box.width, box.height, 0.15, largest, 0.14);
    // A long flow begins at its top in a size that can be read.
    const zoom = Math.min(largest, readable);
    const whole =
      view.zoom >= smallest
        ? view
        : { x: box.width / 2 - (bounds.x + bounds.width / 2) * zoom, y: 28 - bounds.y * zoom, zoom };
    const wanted = props.selected.has(asked) ? fromModel.find((n) => n.id === asked) : undefined;
    void flow.setViewport(wanted ? withPiece(wanted, whole, box) : whole, {
      duration: lessMotion() ? 0 : 190,
    });
  };
  const latestShow = useRef(show);
  latestShow.current = show;
  useRefit(pane, fromModel, flow.getViewport, () => latestShow.current(1));
  const traced = props.trial !== null; // a panel has made the canvas smaller
  useEffect(() => {
    const t = window.setTimeout(() => latestShow.current(1), 60);
    return () => window.clearTimeout(t);
  }, [flow, shown.flow.key, props.refreshed, traced]);
  // The step at which a simulation is comes into view.
  const isIn = (state: string) => shown.steps.find((s) => props.trial?.get(s.name)?.state === state)?.key;
  const active = isIn("running") ?? isIn("waiting") ?? "";
  const latestNodes = useRef(fromModel);
  latestNodes.current = fromModel;
  useEffect(() => {
    const t = window.setTimeout(() => {
      const node = latestNodes.current.find((n) => n.id === active);
      const box = pane.current?.getBoundingClientRect();
      const before = flow.getViewport();
      const view = node && box ? withPiece(node, before, box) : before;
      if (view !== before) void flow.setViewport(view, { duration: lessMotion() ? 0 : 190 });
    }, 120); // after the whole flow was shown
    return () => window.clearTimeout(t);
  }, [flow, active]);
  const count = shown.steps.length;
  const placedByHand = placed(shown.steps);
  useEffect(() => {
    if (placedByHand) return;
    const t = window.setTimeout(() => latestShow.current(Math.min(1, Math.max(0.6, flow.getZoom()))), 60);
    return () => window.clearTimeout(t);
  }, [flow, count, placedByHand]);

  const commit = () => {
    window.clearTimeout(timer.current);
    const keys = [...moved.current];
    moved.current.clear();
    const moves = keys.flatMap((key) => {
      const node = flow.getNode(key);
      return node ? [{ key, ...node.position }] : [];
    });
    if (moves.length > 0) actions.move(moves);
  };

  const onNodesChange = (changes: NodeChange<StepNode>[]) => {
    setNodes((before) => applyNodeChanges(changes, before));
    let selection: Set<string> | null = null;
    let byKeys = false;
    for (const change of changes) {
      if (change.type === "position" && change.position) {
        moved.current.add(change.id);
        if (change.dragging !== true) byKeys = true;
      } else if (change.type === "select") {
        selection ??= new Set(props.selected);
        if (change.selected) selection.add(change.id);
        else selection.delete(change.id);
      }
    }
    if (selection) props.onSelect([...selection], [...selectedLinks]);
    if (byKeys) {
      window.clearTimeout(timer.current);
      timer.current = window.setTimeout(commit, 350); // arrows that follow each other are one move
    }
  };
  const onEdgesChange = (changes: EdgeChange<LinkEdgeType>[]) => {
    const links = new Set(selectedLinks);
    let any = false;
    for (const change of changes)
      if (change.type === "select") {
        any = true;
        if (change.selected) links.add(change.id);
        else links.delete(change.id);
      }
    if (any) props.onSelect([...props.selected], [...links]);
  };

  const byName = useMemo(() => new Map(shown.steps.map((s) => [s.name, s.key])), [shown]);
  const badLinks = useMemo(
    () => new Set(props.findings.filter((f) => f.flow === shown.flow.key && f.link).map((f) => f.link)),
    [props.findings, shown],
  );
  const edges = useMemo(
    () =>
      shown.links.flatMap((link): LinkEdgeType[] => {
        const source = byName.get(link.from);
        const target = byName.get(link.to);
        if (source === undefined || target === undefined) return [];
        const bad = badLinks.has(link.key);
        return [
          {
            id: link.key,
            source,
            target,
            type: "link",
            selected: selectedLinks.has(link.key),
            ariaLabel: `Link from ${link.from} to ${link.to}`,
            className: `${link.kind}${link.stale ? " unmended" : ""}${bad ? " bad" : ""}${hovered === link.key ? " target" : ""}`,
            data: { link, onInsert: (key: string) => onQuickAdd({ link: key }) },
            markerEnd: { type: MarkerType.ArrowClosed, width: 15, height: 15, color: "context-stroke" },
          },
        ];
      }),
    [shown, byName, badLinks, selectedLinks, onQuickAdd, hovered],
  );

  const linkAt = (x: number, y: number): string | null => {
    for (const element of document.elementsFromPoint(x, y)) {
      const label = element.closest("[data-link]")?.getAttribute("data-link");
      const edge = element.closest(".react-flow__edge")?.getAttribute("data-id");
      if (label ?? edge) return label ?? edge ?? null;
    }
    return null;
  };
  const drop = (event: React.DragEvent) => {
    event.preventDefault();
    const text = event.dataTransfer.getData(dragType);
    setHovered(null);
    if (!text) return;
    const link = linkAt(event.clientX, event.clientY);
    const at = flow.screenToFlowPosition({ x: event.clientX, y: event.clientY });
    actions.add(JSON.parse(text) as NewKind, {
      ...(link && { link }),
      position: { x: at.x - stepWidth / 2, y: at.y - 22 },
    });
  };
  const onConnectEnd: OnConnectEnd = (event, state) => {
    if (state.isValid || !state.fromNode || state.fromHandle?.type !== "source" || state.toNode) return;
    const point = "changedTouches" in event ? event.changedTouches[0] : event;
    if (!point) return;
    const at = flow.screenToFlowPosition({ x: point.clientX, y: point.clientY });
    onQuickAdd({ after: state.fromNode.id, position: { x: at.x - stepWidth / 2, y: at.y } });
  };
  const dragStop = (event: MouseEvent | TouchEvent | React.MouseEvent, node: StepNode, all: StepNode[]) => {
    const point = "changedTouches" in event ? event.changedTouches[0] : event;
    const alone =
      all.length === 1 &&
      !shown.links.some((l) => l.from === node.data.step.name || l.to === node.data.step.name);
    const link = alone && point ? linkAt(point.clientX, point.clientY) : null;
    if (link) actions.spliceExisting(link, node.id);
    commit();
  };

  return (
    <div
      className={`canvas${calm ? " calm" : ""}`}
      ref={pane}
      tabIndex={-1} // a click beside the steps gives it the keys
      onPointerDownCapture={() => document.getSelection()?.removeAllRanges()} // text that is selected elsewhere is no longer meant
      onDragOver={(e) => {
        if (!dragged.what) return;
        e.preventDefault();
        e.dataTransfer.dropEffect = "copy";
        setHovered(linkAt(e.clientX, e.clientY));
      }}
      onDragLeave={() => setHovered(null)}
      onDrop={drop}
    >
      <ReactFlow<StepNode, LinkEdgeType>
        nodes={nodes}
        edges={edges}
        nodeTypes={nodeTypes}
        edgeTypes={edgeTypes}
        onNodesChange={onNodesChange}
        onEdgesChange={onEdgesChange}
        onConnect={(c) => actions.connect(c.source, c.target)}
        onConnectEnd={onConnectEnd}
        onNodeDragStop={dragStop}
        onSelectionDragStop={commit}
        onNodeDoubleClick={(_, node) => props.onOpen(node.id)}
        connectionMode={ConnectionMode.Strict}
        connectionRadius={36}
        deleteKeyCode={null}
        selectionKeyCode="Shift"
        multiSelectionKeyCode={["Meta", "Control"]}
        selectionMode={SelectionMode.Partial}
        panOnScroll
        zoomOnDoubleClick={false}
        minZoom={0.15}
        maxZoom={2}
        snapToGrid
        snapGrid={[4, 4]}
        fitView={nodes.length <= 120}
        fitViewOptions={{ padding: 0.16, maxZoom: 1 }}
        onlyRenderVisibleElements={nodes.length > 120}
        nodesFocusable
        edgesFocusable
        disableKeyboardA11y={false}
        autoPanOnNodeFocus
        proOptions={{ hideAttribution: false }}
        attributionPosition="bottom-left"
      >
        <Background variant={BackgroundVariant.Dots} gap={20} size={1.4} color="var(--dots)" />
        <Controls
          showInteractive={false}
          position="bottom-right"
          fitViewOptions={{ padding: 0.16, maxZoom: 1, duration: 190 }}
        />
      </ReactFlow>
      {props.children}
    </div>
  );
}
