// What the model consists of: each mesh with its name and count, and whether it is to be simplified.
import { formatCount } from '../../format.ts';
import { t } from '../../messages/messages.ts';
import type { SceneNode } from '../../scene.ts';

interface SceneTreeProps {
  readonly scene: readonly SceneNode[];
  /** At the level shown; null at full detail. */
  readonly counts: ReadonlyMap<number, number> | null;
  /** Numbers of the meshes that stay as they are. */
  readonly kept: readonly number[];
  onKept(kept: readonly number[]): void;
}

export function SceneTree({ scene, counts, kept, onKept }: SceneTreeProps) {
  const toggle = (mesh: number, simplified: boolean): void =>
    onKept(simplified ? kept.filter((other) => other !== mesh) : [...kept, mesh].sort((a, b) => a - b));
  return (
    <>
      <p class="hint">{t('scene.hint')}</p>
      <ul class="scene-tree">
        {scene.map(({ name, depth, mesh, triangles }, index) => {
          const text = name || t('scene.unnamed', { number: (mesh ?? index) + 1 });
          const now = mesh === null ? undefined : counts?.get(mesh);
          return (
            <li key={index} style={{ '--depth': String(Math.min(depth, 6)) }}>
              {mesh === null ? (
                <span class="scene-group">{text}</span>
              ) : (
                <label class="check">
                  <input type="checkbox" checked={!kept.includes(mesh)} onChange={(event) => toggle(mesh, event.currentTarget.checked)} />
                  <span class="scene-name">{text}</span>
                </label>
              )}
              <span class="scene-count">{now === undefined || now === triangles ? formatCount(triangles) : `${formatCount(now)} / ${formatCount(triangles)}`}</span>
            </li>
          );
        })}
      </ul>
    </>
  );
}
