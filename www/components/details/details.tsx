// What came of it, at length: what was saved, where the bytes are, why there are no fewer triangles, remarks on the file.
import type { Parts } from 'decimesh/worker';
import { reasonText, reasonsOf } from '../../blockers.ts';
import { formatBytes, formatCount, formatDownloadTime, formatLength, formatShare } from '../../format.ts';
import { t } from '../../messages/messages.ts';
import { warningText } from '../../notices.ts';
import type { Model } from '../../state.ts';
import './details.css';

const PARTS = ['geometry', 'textures', 'animation', 'other'] as const satisfies ReadonlyArray<keyof Parts>;

/** Reasons that are told; the rest hardly matters. */
const MOST_REASONS = 3;

interface DetailsProps {
  readonly model: Model;
  readonly outputCurrent: boolean;
  onArrival(): void;
}

export function Details({ model, outputCurrent, onArrival }: DetailsProps) {
  const { source, shown, output, history, warnings, measurement } = model;
  const made = output?.parts ?? null;
  const textures = output === null ? 0 : (made?.textures ?? 0) / output.bytes;
  const share = (length: number): string => formatShare(source.diagonal > 0 ? length / source.diagonal : 0);
  return (
    <>
      <dl class={outputCurrent ? 'facts' : 'facts pending'}>
        <Fact name={t('details.saved')} value={output === null ? '…' : savedText(source.bytes, output.bytes)} />
        <Fact
          name={t('details.time')}
          value={output === null ? '…' : t('details.insteadOf', { after: formatDownloadTime(output.bytes), before: formatDownloadTime(source.bytes) })}
        />
        <Fact name={t('results.triangles')} value={t('details.ofAll', { after: shown.triangles, before: source.triangles })} />
        <Fact name={t('results.vertices')} value={t('details.ofAll', { after: shown.vertices, before: source.vertices })} />
        <Fact name={t('results.estimated')} value={`${share(shown.estimatedError)} (${t('results.units', { length: formatLength(shown.estimatedError) })})`} />
        <Fact name={t('results.measured')} value={measurement.kind === 'done' ? `${share(measurement.deviation.max)} ${t('results.atMost')}` : t('details.notMeasured')} />
      </dl>

      <h3>{t('details.parts')}</h3>
      <table class="figures parts">
        <thead>
          <tr>
            <th scope="col">{t('details.part')}</th>
            <th scope="col">{t('details.before')}</th>
            <th scope="col">{t('details.after')}</th>
          </tr>
        </thead>
        <tbody>
          {PARTS.map((name) => (
            <tr key={name}>
              <th scope="row">{t(`part.${name}`)}</th>
              <td>{model.parts === null ? '…' : formatBytes(model.parts[name])}</td>
              <td>{made === null ? '…' : formatBytes(made[name])}</td>
            </tr>
          ))}
        </tbody>
      </table>
      {output !== null && textures > 0.5 && <p class="hint">{t('details.textures', { share: formatShare(textures) })}</p>}

      <h3>{t('arrival.progressive')}</h3>
      <p class="hint">{t('arrival.hint')}</p>
      <button type="button" class="secondary arrival-button" onClick={onArrival}>{t('arrival.title')}</button>

      <h3>{t('details.why')}</h3>
      {history.kind !== 'ready' ? (
        <p class="hint">{t(history.kind === 'recording' ? 'details.why.wait' : 'details.why.none')}</p>
      ) : history.blockers === null ? (
        <p>{t('details.fewest', { count: history.fewestTriangles })}</p>
      ) : (
        <>
          <p>{t('details.fewest', { count: history.fewestTriangles })}</p>
          <ul class="reasons">
            {reasonsOf(history.blockers).slice(0, MOST_REASONS).map((reason) => (
              <li key={reason.kind}>
                {reasonText(reason)}. <span class="hint">{t(`advice.${reason.kind}`)}</span>
              </li>
            ))}
          </ul>
        </>
      )}

      <h3>{t('remarks.title', { count: warnings.length })}</h3>
      {warnings.length === 0 ? (
        <p class="hint">{t('remarks.none')}</p>
      ) : (
        <ul class="remarks">
          {warnings.map((warning, index) => (
            <li key={index}>
              {warningText(warning)} <span class="hint">{t('remarks.exactly', { message: warning.message })} <code>{warning.where || warning.code}</code></span>
            </li>
          ))}
        </ul>
      )}
      <p class="hint details-format">{t('details.format', { format: source.format.toUpperCase(), size: formatBytes(source.bytes), meshes: formatCount(source.meshes) })}</p>
    </>
  );
}

function savedText(before: number, after: number): string {
  if (after >= before) return t('details.larger', { share: formatShare(after / Math.max(before, 1) - 1) });
  return t('details.smaller', { share: formatShare(1 - after / before), size: formatBytes(before - after) });
}

function Fact({ name, value }: { readonly name: string; readonly value: string }) {
  return (
    <div>
      <dt>{name}</dt>
      <dd>{value}</dd>
    </div>
  );
}
