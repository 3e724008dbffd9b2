// A value that components and other code share: whoever uses it is drawn again when another value is set.
import { useSyncExternalStore } from "react";

export interface Store<T> {
  get: () => T;
  set: (value: T) => void; // the same value (Object.is) tells nobody
  subscribe: (listener: () => void) => () => void; // ends the telling
  use: () => T; // a hook
}

export function createStore<T>(value: T): Store<T> {
  const listeners = new Set<() => void>();
  const get = () => value;
  const subscribe = (listener: () => void) => {
    listeners.add(listener);
    return () => void listeners.delete(listener);
  };
  return {
    get,
    set: (next) => {
      if (Object.is(value, next)) return;
      value = next;
      for (const listener of [...listeners]) listener();
    },
    subscribe,
    use: function useStore() {
      return useSyncExternalStore(subscribe, get);
    },
  };
}
