// The slider `Triangles`: its value is the count itself, its length is logarithmic.
import type { ComponentChildren } from 'preact';
import { useRef } from 'preact/hooks';
import { formatCount, formatShare } from '../../format.ts';
import { t } from '../../messages/messages.ts';
import { clamp } from '../../state.ts';
import { useDraft } from '../number-field/draft.ts';
import { positionOfTriangles, trianglesAtPosition } from './scale.ts';
import './lod-slider.css';

/** Shares of the original that can be chosen by a touch. */
const MARKS = [1, 0.75, 0.5, 0.25, 0.1, 0.05];
/** Counts that applications ask for: a hero of a game, a thing on a page, one of many. */
const BUDGETS = [70_000, 32_000, 5000];
/** Part of the scale that an arrow key and a page key move. */
const ARROW_STEP = 0.01;
const PAGE_STEP = 0.1;
/** Width of the thumb; the scale runs between its centres at both ends. Same as in the style sheet. */
const THUMB = 26;

interface LodSliderProps {
  readonly value: number;
  readonly fewest: number;
  readonly all: number;
  /** Whether what is drawn is not yet what is asked for. */
  readonly pending: boolean;
  /** `gesture` is the same for moves that belong together. */
  onChange(triangles: number, gesture: number): void;
  /** What else stands in the slider's first line. */
  readonly children?: ComponentChildren;
}

let lastGesture = 0;

export function LodSlider({ value, fewest, all, pending, onChange, children }: LodSliderProps) {
  const gesture = useRef(0);
  const dragging = useRef(false);
  const position = positionOfTriangles(value, fewest, all);
  const startGesture = (): void => {
    gesture.current = lastGesture += 1;
  };

  const choose = (count: number): void => {
    startGesture();
    onChange(count, gesture.current);
  };

  const moveToPointer = (event: PointerEvent & { currentTarget: HTMLInputElement }): void => {
    const box = event.currentTarget.getBoundingClientRect();
    const along = (event.clientX - box.left - THUMB / 2) / Math.max(box.width - THUMB, 1);
    onChange(trianglesAtPosition(clamp(along, 0, 1), fewest, all), gesture.current);
  };

  const onKeyDown = (event: KeyboardEvent): void => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const next = keyTarget(event, value, position, fewest, all);
    if (next === undefined) return;
    event.preventDefault();
    if (!event.repeat) startGesture();
    onChange(next, gesture.current);
  };

  return (
    <div class="lod-slider">
      <div class="lod-head">
        <label for="triangles">{t('slider.triangles')}</label>
        <CountField value={value} fewest={fewest} all={all} onCommit={choose} />
        <span class={pending ? 'lod-share pending' : 'lod-share'}>{formatShare(value / all)}</span>
        {children}
      </div>
      <div class="lod-track" style={{ '--at': String(position) }}>
        <div class="lod-rail" aria-hidden="true" />
        <input
          id="triangles"
          type="range"
          min={fewest}
          max={all}
          step={1}
          value={value}
          aria-valuetext={t('slider.value', { wanted: value, all, share: formatShare(value / all) })}
          onPointerDown={(event) => {
            if (event.button !== 0) return;
            // The browser would put the thumb where a linear scale has it.
            event.preventDefault();
            event.currentTarget.focus({ focusVisible: false } as FocusOptions);
            event.currentTarget.setPointerCapture(event.pointerId);
            dragging.current = true;
            startGesture();
            moveToPointer(event);
          }}
          onPointerMove={(event) => {
            if (dragging.current) moveToPointer(event);
          }}
          onPointerUp={() => { dragging.current = false; }}
          onPointerCancel={() => { dragging.current = false; }}
          onKeyDown={onKeyDown}
          onInput={(event) => {
            // Assistive technology sets the value without pointer or keys.
            choose(event.currentTarget.valueAsNumber);
          }}
        />
        <div class="lod-thumb" aria-hidden="true" />
      </div>
      <div class="lod-marks">
        {MARKS.filter((share) => all * share >= Math.max(fewest, 3) || share === 1).map((share) => (
          <Mark key={share} text={formatShare(share)} name={t('slider.keep', { share: formatShare(share) })} count={Math.round(all * share)} value={value} onChoose={choose} />
        ))}
        <span class="lod-marks-gap" />
        {BUDGETS.filter((count) => count < all && count >= fewest).map((count) => (
          <Mark key={count} text={`${count / 1000}k`} name={`${count / 1000}k: ${t('slider.budget', { count })}`} count={count} value={value} onChoose={choose} />
        ))}
      </div>
    </div>
  );
}

interface MarkProps {
  readonly text: string;
  readonly name: string;
  readonly count: number;
  readonly value: number;
  onChoose(count: number): void;
}

/** A count that can be chosen by one touch. */
function Mark({ text, name, count, value, onChoose }: MarkProps) {
  return (
    <button type="button" aria-label={name} title={name} aria-pressed={count === value} onClick={() => onChoose(count)}>
      {text}
    </button>
  );
}

function keyTarget(event: KeyboardEvent, value: number, position: number, fewest: number, all: number): number | undefined {
  const move = (by: number): number => {
    if (event.shiftKey) return value + Math.sign(by);
    const next = trianglesAtPosition(position + by, fewest, all);
    // Where the scale is finer than whole triangles, a key still moves one.
    return next === value ? value + Math.sign(by) : next;
  };
  switch (event.key) {
    case 'ArrowRight':
    case 'ArrowUp':
      return move(ARROW_STEP);
    case 'ArrowLeft':
    case 'ArrowDown':
      return move(-ARROW_STEP);
    case 'PageUp':
      return move(PAGE_STEP);
    case 'PageDown':
      return move(-PAGE_STEP);
    case 'Home':
      return fewest;
    case 'End':
      return all;
    default:
      return undefined;
  }
}

interface CountFieldProps {
  readonly value: number;
  readonly fewest: number;
  readonly all: number;
  onCommit(triangles: number): void;
}

/** The count in figures, to be typed over; what is typed counts at Enter or when the field is left. */
function CountField({ value, fewest, all, onCommit }: CountFieldProps) {
  const draft = useDraft(formatCount(value), (typed) => {
    // Thousands separators of any custom are skipped, and so is a unit.
    const count = Number(typed.replace(/[^\d]/g, '') || Number.NaN);
    if (Number.isFinite(count)) onCommit(clamp(count, fewest, all));
  });
  return (
    <input
      class="lod-count"
      type="text"
      inputMode="numeric"
      autocomplete="off"
      aria-label={t('slider.exact')}
      style={{ '--digits': String(Math.max(draft.value.length, 1)) }}
      {...draft}
    />
  );
}
