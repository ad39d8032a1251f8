// What is shown of a model that arrives, and the pure transitions between its values.
import type { State } from '../state.ts';

/** Connections to watch it over; `none` lets everything come at once. */
export const SPEEDS = ['slow', 'third', 'fourth', 'none'] as const;

/** The name of a connection. */
export type Speed = (typeof SPEEDS)[number];

/** Bytes a second, as browsers' tools throttle to: 400 kbit/s, 1.6 Mbit/s, 9 Mbit/s. */
export const BYTES_A_SECOND: Readonly<Record<Speed, number>> = { slow: 50_000, third: 200_000, fourth: 1_125_000, none: Infinity };

/** Whether `value` names a connection. */
export const isSpeed = (value: string): value is Speed => (SPEEDS as readonly string[]).includes(value);

/** A model on its way, from being made a progressive mesh of to having arrived. */
export interface ArrivalState {
  readonly phase: 'making' | 'arriving' | 'paused' | 'arrived';
  /** Of the making, 0..1; null while that is unknown. */
  readonly fraction: number | null;
  readonly speed: Speed;
  /** Levels go over into each other. */
  readonly smooth: boolean;
  /** Bytes of the whole, 0 while it is made, and of it what has come. */
  readonly bytes: number;
  readonly received: number;
  /** Milliseconds since the first byte, without pauses. */
  readonly elapsed: number;
  /** Of the level on screen; 0 before the first. */
  readonly triangles: number;
  /** When the first level was on screen, with the bytes that had come. */
  readonly first: { readonly elapsed: number; readonly received: number } | null;
  /** Bytes of the same geometry as a GLB, as it is and with Meshopt. */
  readonly rivals: { readonly plain: number; readonly meshopt: number } | null;
}

/** A model is to arrive: nothing stands beside the view but that. */
export const arrivalOpened = (state: State, smooth: boolean): State => ({
  ...state,
  sheet: null,
  paint: null,
  notice: null,
  remark: '',
  arrival: {
    phase: 'making', fraction: 0, speed: 'third', smooth, bytes: 0, received: 0, elapsed: 0, triangles: 0, first: null, rivals: null,
  },
});

export const arrivalChanged = (state: State, change: Partial<ArrivalState>): State =>
  state.arrival === null ? state : { ...state, arrival: { ...state.arrival, ...change } };

/** It begins, or begins again. */
export const arrivalStarted = (state: State, change: Partial<ArrivalState>): State =>
  arrivalChanged({ ...state, remark: '' }, { ...change, phase: 'arriving', received: 0, elapsed: 0, triangles: 0, first: null });

export const arrivalClosed = (state: State): State => (state.arrival === null ? state : { ...state, arrival: null, remark: '' });
