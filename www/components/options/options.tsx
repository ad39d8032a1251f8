// All that can be chosen about the simplification beside the slider, folded by what it is about.
import type { ComponentChildren } from 'preact';
import { DEFAULT_RUN, runKey } from '../../choices.ts';
import type { Goal, RunSettings } from '../../choices.ts';
import { formatBytes } from '../../format.ts';
import { t } from '../../messages/messages.ts';
import { choicesOf } from '../../state.ts';
import { NO_PREPARATION, preparationKey } from '../../preparation.ts';
import type { Preparation as Preparations } from '../../preparation.ts';
import type { Model, State } from '../../state.ts';
import { missedSize } from '../../status.ts';
import { NumberField } from '../number-field/number-field.tsx';
import { Levels } from './levels.tsx';
import { Preparation } from './preparation.tsx';
import { RecipeButtons } from './recipe-buttons.tsx';
import { SceneTree } from './scene-tree.tsx';
import { Weights } from './weights.tsx';
import './options.css';

export interface OptionsActions {
  chooseGoal(goal: Goal): void;
  changeRun(change: Partial<RunSettings>): void;
  changePreparation(change: Partial<Preparations>): void;
  chooseLods(lods: readonly number[]): void;
  chooseMeshes(kept: readonly number[]): void;
  resetChoices(): void;
  /** Says something in the live region. */
  remark(text: string): void;
}

interface OptionsProps {
  readonly state: State;
  readonly model: Model;
  readonly actions: OptionsActions;
}

/** Bytes in the unit that is typed. */
const MEGABYTE = 1e6;

export function Options({ state, model, actions }: OptionsProps) {
  const { goal, run, lods, outputFormat, preparation } = state;
  // Compared as for a GLB: for other formats they are kept, and count for nothing.
  const prepared = preparationKey('glb', preparation) !== preparationKey('glb', NO_PREPARATION);
  const limit = goal.kind === 'error' ? `${goal.percent} %` : goal.kind === 'size' ? formatBytes(goal.bytes) : '';
  const weighed = JSON.stringify(run.weights) !== JSON.stringify(DEFAULT_RUN.weights);
  const meshes = new Set(model.scene.flatMap(({ mesh }) => (mesh === null ? [] : [mesh])));
  const changed = runKey(run) !== runKey(DEFAULT_RUN) || goal.kind !== 'triangles' || lods.length > 0 || state.quality !== 'balanced' || prepared;
  return (
    <>
      <Fold title={t('options.limits')} value={limit} open>
        <p class="hint">{t('options.limits.hint')}</p>
        <NumberField
          id="goal-error"
          label={t('options.error')}
          unit="%"
          value={goal.kind === 'error' ? goal.percent : null}
          low={1e-6}
          high={100}
          onCommit={(percent) => actions.chooseGoal(percent === null ? { kind: 'triangles' } : { kind: 'error', percent })}
        />
        <NumberField
          id="goal-size"
          label={t('options.size')}
          unit="MB"
          value={goal.kind === 'size' ? goal.bytes / MEGABYTE : null}
          low={1e-4}
          high={1e5}
          onCommit={(size) => actions.chooseGoal(size === null ? { kind: 'triangles' } : { kind: 'size', bytes: Math.round(size * MEGABYTE) })}
        />
        {missedSize(state) !== '' && <p class="warning">{missedSize(state)}</p>}
      </Fold>
      <Fold title={t('options.simplifying')} value={run.lockBorder || run.prune || weighed ? t('options.changed') : ''} open>
        <Check label={t('options.lockBorder')} hint={t('options.lockBorder.hint')} checked={run.lockBorder} onChange={(lockBorder) => actions.changeRun({ lockBorder })} />
        <Check label={t('options.prune')} hint={t('options.prune.hint')} checked={run.prune} onChange={(prune) => actions.changeRun({ prune })} />
        <Weights weights={run.weights} onWeights={(weights) => actions.changeRun({ weights })} />
      </Fold>
      {meshes.size > 1 && (
        <Fold title={t('options.meshes')} value={run.kept.length > 0 ? t('options.kept', { count: run.kept.length }) : ''}>
          <SceneTree scene={model.scene} counts={model.meshTriangles} kept={run.kept} onKept={actions.chooseMeshes} />
        </Fold>
      )}
      <Fold title={t('options.levels')} value={lods.length > 1 && outputFormat === 'glb' ? String(lods.length) : ''}>
        <Levels lods={lods} possible={outputFormat === 'glb'} output={model.output} onLods={actions.chooseLods} />
      </Fold>
      <Fold title={t('options.preparation')} value={prepared && outputFormat === 'glb' ? t('options.changed') : ''}>
        <Preparation
          preparation={preparation}
          possible={outputFormat === 'glb'}
          textured={model.parts === null ? null : model.parts.textures > 0}
          onChange={actions.changePreparation}
        />
      </Fold>
      <Fold title={t('options.recipe')} value="">
        <RecipeButtons
          recipe={{ fileName: model.fileName, name: model.name, triangles: model.wantedTriangles, choices: choicesOf(state) }}
          onCopied={() => actions.remark(t('recipe.copied'))}
        />
      </Fold>
      <button type="button" class="secondary options-reset" disabled={!changed} onClick={actions.resetChoices}>{t('options.reset')}</button>
    </>
  );
}

interface FoldProps {
  readonly title: string;
  /** What differs from the usual, for when it is closed. */
  readonly value: string;
  readonly open?: boolean;
  readonly children: ComponentChildren;
}

function Fold({ title, value, open = false, children }: FoldProps) {
  return (
    <details class="sheet-fold" open={open || undefined}>
      <summary>
        {title}
        {value !== '' && <span class="summary-value">{value}</span>}
      </summary>
      <div class="sheet-fold-body">{children}</div>
    </details>
  );
}

interface CheckProps {
  readonly label: string;
  readonly hint: string;
  readonly checked: boolean;
  onChange(checked: boolean): void;
}

function Check({ label, hint, checked, onChange }: CheckProps) {
  return (
    <label class="check" title={hint}>
      <input type="checkbox" checked={checked} onChange={(event) => onChange(event.currentTarget.checked)} />
      <span>
        {label}
        <span class="hint"> {hint}</span>
      </span>
    </label>
  );
}
