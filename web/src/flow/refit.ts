// A drawing of steps whose pane changes its shape (a phone is turned, a panel opens): it is fitted again where none of it would be seen.
import { useEffect, useRef, type RefObject } from "react";
import type { Viewport } from "@xyflow/react";

export interface Piece {
  position: { x: number; y: number };
  width?: number | undefined;
  height?: number | undefined;
}

// Whether at least one is wholly seen; of one that is larger than the pane, its middle.
export function isAnySeen(
  pieces: readonly Piece[],
  view: Viewport,
  pane: { width: number; height: number },
): boolean {
  const within = (at: number, size: number, room: number) =>
    size <= room ? at >= 0 && at + size <= room : at + size / 2 >= 0 && at + size / 2 <= room;
  return pieces.some(
    (p) =>
      within(p.position.x * view.zoom + view.x, (p.width ?? 0) * view.zoom, pane.width) &&
      within(p.position.y * view.zoom + view.y, (p.height ?? 0) * view.zoom, pane.height),
  );
}

// The view with the piece in it: as it is where it is wholly seen there, else with the piece in the middle.
export function withPiece(piece: Piece, view: Viewport, pane: { width: number; height: number }): Viewport {
  if (isAnySeen([piece], view, pane)) return view;
  const middle = {
    x: piece.position.x + (piece.width ?? 0) / 2,
    y: piece.position.y + (piece.height ?? 0) / 2,
  };
  return {
    x: pane.width / 2 - middle.x * view.zoom,
    y: pane.height / 2 - middle.y * view.zoom,
    zoom: view.zoom,
  };
}

// The view where not all of a drawing can be read at once: its beginning, with whole steps at the left.
export function beginning(
  bounds: { x: number; y: number; width: number },
  room: number,
  readable: number,
  smallest: number,
): Viewport {
  const margin = 16;
  const zoom = Math.max(smallest, Math.min(readable, (room - 2 * margin) / bounds.width));
  const x =
    bounds.width * zoom <= room - 2 * margin
      ? room / 2 - (bounds.x + bounds.width / 2) * zoom
      : margin - bounds.x * zoom;
  return { x, y: margin - bounds.y * zoom, zoom };
}

export function useRefit(
  pane: RefObject<HTMLElement | null>,
  pieces: readonly Piece[],
  viewport: () => Viewport,
  fit: () => void,
) {
  const latest = useRef({ pieces, viewport, fit });
  latest.current = { pieces, viewport, fit };
  useEffect(() => {
    const element = pane.current;
    if (!element) return;
    let timer = 0;
    let first = true;
    const observer = new ResizeObserver(() => {
      if (first) return void (first = false);
      window.clearTimeout(timer);
      timer = window.setTimeout(() => {
        const { width, height } = element.getBoundingClientRect();
        const now = latest.current;
        if (
          width > 0 &&
          height > 0 &&
          now.pieces.length > 0 &&
          !isAnySeen(now.pieces, now.viewport(), { width, height })
        )
          now.fit();
      }, 80);
    });
    observer.observe(element);
    return () => {
      window.clearTimeout(timer);
      observer.disconnect();
    };
  }, [pane]);
}
