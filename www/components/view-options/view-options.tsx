// Everything about how the model is looked at, in one panel: surface, lines, comparison, light, turning, morph targets.
import type { ComponentChildren } from 'preact';
import { t } from '../../messages/messages.ts';
import type { PlainKey } from '../../messages/messages.ts';
import type { Lamp, Layout, Surface, ViewContents } from '../../preview/protocol.ts';
import type { View } from '../../state.ts';
import './view-options.css';

interface ViewOptionsProps {
  readonly id: string;
  readonly view: View;
  readonly contents: ViewContents;
  /** The system asks for no motion: what moves by itself is not offered. */
  readonly reducedMotion: boolean;
  onView(change: Partial<View>): void;
  onMorph(index: number, weight: number | null): void;
  onClose(): void;
}

const SURFACES: ReadonlyArray<Choice<Surface>> = [
  ['textured', 'seeing.textured'],
  ['shaded', 'seeing.shaded'],
  ['checker', 'seeing.checker'],
  ['normals', 'seeing.normals'],
  ['deviation', 'seeing.deviation'],
];
const LAYOUTS: ReadonlyArray<Choice<Layout>> = [
  ['single', 'seeing.single'],
  ['split', 'seeing.split'],
  ['beside', 'seeing.beside'],
];
const LAMPS: ReadonlyArray<Choice<Lamp>> = [
  ['view', 'seeing.lamp.view'],
  ['model', 'seeing.lamp.model'],
  ['turning', 'seeing.lamp.turning'],
];

export function ViewOptions({ id, view, contents, reducedMotion, onView, onMorph, onClose }: ViewOptionsProps) {
  return (
    <div
      id={id}
      class="panel view-options"
      role="group"
      aria-label={t('seeing.options')}
      onKeyDown={(event) => {
        if (event.key !== 'Escape') return;
        event.stopPropagation();
        onClose();
      }}
    >
      <Choices
        name="surface"
        title={t('seeing.surface')}
        choices={SURFACES}
        value={view.surface}
        refused={contents.textureCoordinates ? {} : { checker: t('seeing.checkerMissing') }}
        onChange={(surface) => onView({ surface })}
      />
      <fieldset>
        <legend>{t('seeing.lines')}</legend>
        <Check checked={view.wireframe} onChange={(wireframe) => onView({ wireframe })}>{t('view.wireframe')}</Check>
        <Check checked={view.edgeClasses} onChange={(edgeClasses) => onView({ edgeClasses })}>{t('seeing.edges')}</Check>
      </fieldset>
      <Choices name="layout" title={t('seeing.layout')} choices={LAYOUTS} value={view.layout} onChange={(layout) => onView({ layout })} />
      <Choices
        name="lamp"
        title={t('seeing.lamp')}
        choices={LAMPS}
        value={view.lamp}
        refused={reducedMotion ? { turning: t('seeing.reducedMotion') } : {}}
        onChange={(lamp) => onView({ lamp })}
      />
      <fieldset>
        <legend>{t('seeing.motion')}</legend>
        {contents.animations.length > 1 && (
          <select class="animation" aria-label={t('view.animation')} value={view.animation} onChange={(event) => onView({ animation: Number(event.currentTarget.value) })}>
            {contents.animations.map((name, index) => (
              <option key={index} value={index}>{name}</option>
            ))}
          </select>
        )}
        <Check
          checked={view.turntable && !reducedMotion}
          refused={reducedMotion ? t('seeing.reducedMotion') : undefined}
          onChange={(turntable) => onView({ turntable })}
        >
          {t('seeing.turntable')}
        </Check>
      </fieldset>
      {contents.morphs.length > 0 && <Morphs view={view} contents={contents} onMorph={onMorph} />}
    </div>
  );
}

type Choice<Value> = readonly [value: Value, name: PlainKey];

interface ChoicesProps<Value extends string> {
  readonly name: string;
  readonly title: string;
  readonly choices: ReadonlyArray<Choice<Value>>;
  readonly value: Value;
  /** Why a choice cannot be had, in words. */
  readonly refused?: Partial<Record<Value, string>>;
  onChange(value: Value): void;
}

function Choices<Value extends string>({ name, title, choices, value, refused = {}, onChange }: ChoicesProps<Value>) {
  return (
    <fieldset>
      <legend>{title}</legend>
      {choices.map(([choice, text]) => {
        const reason = refused[choice];
        return (
          <label key={choice} title={reason}>
            <input
              type="radio"
              name={name}
              checked={choice === value}
              disabled={reason !== undefined}
              onChange={() => onChange(choice)}
            />
            <span>{t(text)}{reason !== undefined && <small>{reason}</small>}</span>
          </label>
        );
      })}
    </fieldset>
  );
}

interface CheckProps {
  readonly checked: boolean;
  readonly refused?: string | undefined;
  readonly children: ComponentChildren;
  onChange(checked: boolean): void;
}

function Check({ checked, refused, children, onChange }: CheckProps) {
  return (
    <label title={refused}>
      <input type="checkbox" checked={checked} disabled={refused !== undefined} onChange={(event) => onChange(event.currentTarget.checked)} />
      <span>{children}{refused !== undefined && <small>{refused}</small>}</span>
    </label>
  );
}

function Morphs({ view, contents, onMorph }: Pick<ViewOptionsProps, 'view' | 'contents' | 'onMorph'>) {
  return (
    <fieldset>
      <legend>{t('seeing.morphs')}</legend>
      {contents.morphs.map(({ name, weight }, index) => {
        const set = view.morphs[index] ?? null;
        const now = set ?? weight;
        return (
          <label key={index} class="morph">
            <span class="morph-name">{/^\d+$/.test(name) ? t('seeing.morph', { number: Number(name) + 1 }) : name}</span>
            <span class="morph-value">{now.toFixed(2)}</span>
            <input
              type="range"
              min={Math.min(0, weight)}
              max={Math.max(1, weight)}
              step={0.01}
              value={now}
              onInput={(event) => onMorph(index, Number(event.currentTarget.value))}
            />
          </label>
        );
      })}
      <button
        type="button"
        class="quiet"
        disabled={view.morphs.every((weight) => weight === null)}
        onClick={() => contents.morphs.forEach((_, index) => onMorph(index, null))}
      >
        {t('seeing.morphsReset')}
      </button>
    </fieldset>
  );
}
