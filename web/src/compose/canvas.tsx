// The canvas: the flow of the text as cards and arrows. What is done here becomes an edit of the text; only a drag that is under
// way, and what is selected, live here.
import {
  Background,
  BackgroundVariant,
  ConnectionMode,
  Controls,
  type OnConnectEnd,
  ReactFlow,
  ReactFlowProvider,
  SelectionMode,
  useReactFlow,
} from "@xyflow/react";
import "@xyflow/react/dist/style.css";
import { useRef, useState, type ReactNode } from "react";
import { stepWidth } from "../cawl/placing";
import type { ShownFlow } from "../cawl/shown";
import { LinkEdge, type LinkEdgeType } from "../flow/link_edge";
import { StepCard, type StepNode } from "../flow/step_card";
import type { Actions, AddWhere, NewKind } from "./actions";
import { linkAt, useLinks } from "./canvas_links";
import { useCalm, useMovedNodes, useNodes } from "./canvas_nodes";
import { useView } from "./canvas_view";
import type { Finding } from "./findings";
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

function Flow(props: CanvasProps) {
  const { shown, actions, onQuickAdd } = props;
  const flow = useReactFlow<StepNode, LinkEdgeType>();
  const pane = useRef<HTMLDivElement>(null);
  const [hovered, setHovered] = useState<string | null>(null);
  const fromModel = useNodes(props);
  const { nodes, commit, onNodesChange } = useMovedNodes(props, fromModel);
  const { edges, onEdgesChange } = useLinks(props, hovered);
  const calm = useCalm(nodes.length, props.refreshed);
  useView(props, fromModel, pane);

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
