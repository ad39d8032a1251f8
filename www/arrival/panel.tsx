// What is known of a model while it arrives, and what can be done about it.
import { useLayoutEffect, useRef } from 'preact/hooks';
import { Icon } from '../components/icon/icon.tsx';
import { Progress } from '../components/progress/progress.tsx';
import { formatBytes, formatCount, formatShare } from '../format.ts';
import { currentLanguage, t } from '../messages/messages.ts';
import { BYTES_A_SECOND, SPEEDS, isSpeed } from './arrival_state.ts';
import type { ArrivalState, Speed } from './arrival_state.ts';
import './panel.css';

interface ArrivalPanelProps {
  readonly arrival: ArrivalState;
  readonly name: string;
  /** Of the whole model. */
  readonly triangles: number;
  readonly reducedMotion: boolean;
  readonly actions: {
    play(change?: { readonly speed?: Speed; readonly smooth?: boolean }): void;
    toggle(): void;
    save(): void;
    close(): void;
  };
}

export function ArrivalPanel({ arrival, name, triangles, reducedMotion, actions }: ArrivalPanelProps) {
  const { phase, received, bytes, elapsed, first, rivals, speed } = arrival;
  const heading = useRef<HTMLHeadingElement>(null);
  useLayoutEffect(() => heading.current?.focus({ preventScroll: true }), []);
  const share = bytes === 0 ? 0 : received / bytes;
  const making = phase === 'making';
  const whole = (size: number | undefined): string =>
    size === undefined ? '…' : speed === 'none' ? formatBytes(size) : t('arrival.sizeAndTime', { size: formatBytes(size), time: formatTime((size / BYTES_A_SECOND[speed]) * 1000) });
  return (
    <section class="panel model-panel arrival" aria-labelledby="arrival-title">
      <header class="arrival-head">
        <h2 id="arrival-title" tabindex={-1} ref={heading}>{t('arrival.title')}</h2>
        <button type="button" class="quiet icon-button" aria-label={t('arrival.close')} title={`${t('arrival.close')} (Esc)`} onClick={() => actions.close()}>
          <Icon name="close" size={18} />
        </button>
      </header>
      {making ? (
        <>
          <p class="hint">{t('arrival.making', { name })}</p>
          <Progress fraction={arrival.fraction} label={t('arrival.making', { name })} onCancel={() => actions.close()} />
        </>
      ) : (
        <>
          <div class="arrival-bar" role="progressbar" aria-label={t('arrival.received')} aria-valuemin={0} aria-valuemax={100} aria-valuenow={Math.floor(share * 100)}>
            <div style={{ transform: `scaleX(${share})` }} />
            {first !== null && <span class="arrival-mark" style={{ '--at': first.received / bytes }} />}
          </div>
          <dl class="arrival-figures">
            <Figure name={t('arrival.received')} value={formatShare(share)} more={t('details.ofAll', { after: formatBytes(received), before: formatBytes(bytes) })} />
            <Figure name={t('results.triangles')} value={formatCount(arrival.triangles)} more={t('results.of', { before: formatCount(triangles) })} />
            <Figure name={t('arrival.time')} value={formatTime(elapsed)} more={t(`arrival.phase.${phase}`)} />
            <Figure
              name={t('arrival.first')}
              value={first === null ? '…' : formatTime(first.elapsed)}
              more={first === null ? '' : t('arrival.firstShare', { share: formatShare(first.received / bytes) })}
            />
            <Figure name={t('arrival.glb')} value={whole(rivals?.plain)} more={t('arrival.meshopt', { size: whole(rivals?.meshopt) })} />
          </dl>
        </>
      )}
      <div class="arrival-foot">
        <button type="button" class="primary" disabled={making} title={`${t(buttonOf(phase))} (${t('arrival.space')})`} onClick={() => actions.toggle()}>
          <Icon name={phase === 'arriving' ? 'pause' : phase === 'arrived' ? 'redo' : 'play'} />
          <span>{t(buttonOf(phase))}</span>
        </button>
        <select aria-label={t('arrival.connection')} value={speed} onChange={(event) => isSpeed(event.currentTarget.value) && actions.play({ speed: event.currentTarget.value })}>
          {SPEEDS.map((name) => <option key={name} value={name}>{t(`arrival.speed.${name}`)}</option>)}
        </select>
        <label class="check" title={reducedMotion ? t('seeing.reducedMotion') : undefined}>
          <input type="checkbox" checked={arrival.smooth} disabled={reducedMotion} onChange={(event) => actions.play({ smooth: event.currentTarget.checked })} />
          <span>{t('arrival.smooth')}</span>
        </label>
        <button type="button" class="secondary" disabled={making} onClick={() => actions.save()}>{t('arrival.save')}</button>
      </div>
      <p class="hint">{t('arrival.note')}</p>
    </section>
  );
}

const buttonOf = (phase: ArrivalState['phase']) => (phase === 'arriving' ? 'arrival.pause' : phase === 'arrived' ? 'arrival.again' : 'arrival.resume');

function Figure({ name, value, more }: { readonly name: string; readonly value: string; readonly more: string }) {
  return (
    <div class="figure">
      <dt>{name}</dt>
      <dd>
        <span class="after">{value}</span>
        <span class="before">{more}</span>
      </dd>
    </div>
  );
}

/** Milliseconds as seconds: `0.42 s`. */
export function formatTime(milliseconds: number): string {
  const digits = milliseconds < 1000 ? 2 : 1;
  return t('figure.seconds', { value: (milliseconds / 1000).toLocaleString(currentLanguage(), { minimumFractionDigits: digits, maximumFractionDigits: digits }) });
}
