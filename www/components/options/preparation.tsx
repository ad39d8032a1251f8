// The file beside its geometry: tidied up or not, and how large, as what and how fine its textures are.
import { t } from '../../messages/messages.ts';
import { TEXTURE_FORMATS, TEXTURE_SIZES, USUAL_TEXTURE_QUALITY } from '../../preparation.ts';
import type { Preparation as Choices, TextureFormat } from '../../preparation.ts';

interface PreparationProps {
  readonly preparation: Choices;
  /** Whether the file format can have any of it. */
  readonly possible: boolean;
  /** Whether the model has textures; null while that is unknown. */
  readonly textured: boolean | null;
  onChange(change: Partial<Choices>): void;
}

const FORMAT_NAMES: Readonly<Record<TextureFormat, string>> = { webp: 'WebP', jpeg: 'JPEG', png: 'PNG' };

export function Preparation({ preparation, possible, textured, onChange }: PreparationProps) {
  const { tidy, textureSize, textureFormat, textureQuality } = preparation;
  const sizes = textureSize === null || TEXTURE_SIZES.includes(textureSize) ? TEXTURE_SIZES : [textureSize, ...TEXTURE_SIZES];
  const disabled = !possible || textured === false;
  // Pixels kept as they are have no quality to choose, nor has PNG.
  const lossless = textureFormat === 'png' || (textureFormat === null && textureSize === null && textureQuality === null);
  const quality = textureQuality ?? USUAL_TEXTURE_QUALITY;
  return (
    <>
      <label class="check">
        <input type="checkbox" checked={tidy} disabled={!possible} onChange={(event) => onChange({ tidy: event.currentTarget.checked })} />
        <span>
          {t('prepare.tidy')}
          <span class="hint"> {t(possible ? 'prepare.tidy.hint' : 'prepare.glbOnly')}</span>
        </span>
      </label>
      <fieldset class="textures">
        <legend>{t('prepare.textures')}</legend>
        {textured === false && <p class="hint">{t('prepare.noTextures')}</p>}
        <label>
          <span>{t('prepare.size')}</span>
          <select
            disabled={disabled}
            value={textureSize ?? ''}
            onChange={(event) => onChange({ textureSize: event.currentTarget.value === '' ? null : Number(event.currentTarget.value) })}
          >
            <option value="">{t('prepare.asIs')}</option>
            {sizes.map((size) => <option key={size} value={size}>{t('prepare.pixels', { count: size })}</option>)}
          </select>
        </label>
        <label>
          <span>{t('prepare.format')}</span>
          <select
            disabled={disabled}
            value={textureFormat ?? ''}
            onChange={(event) => onChange({ textureFormat: TEXTURE_FORMATS.find((format) => format === event.currentTarget.value) ?? null })}
          >
            <option value="">{t('prepare.asIs')}</option>
            {TEXTURE_FORMATS.map((format) => <option key={format} value={format}>{FORMAT_NAMES[format]}</option>)}
          </select>
        </label>
        <label>
          <span>{t('prepare.quality')}</span>
          <span class="texture-quality">
            <input
              type="range"
              min={10}
              max={100}
              step={5}
              disabled={disabled || lossless}
              value={quality}
              aria-valuetext={`${quality} %`}
              // Each value is an encoding of its own: it counts when the slider is let go.
              onChange={(event) => {
                const chosen = event.currentTarget.valueAsNumber;
                onChange({ textureQuality: chosen === USUAL_TEXTURE_QUALITY ? null : chosen });
              }}
            />
            <span class="weight-value" aria-hidden="true">{quality} %</span>
          </span>
        </label>
        {textureFormat === 'webp' && possible && <p class="hint">{t('prepare.webp')}</p>}
      </fieldset>
    </>
  );
}
