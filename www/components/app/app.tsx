// The page as a function of its state: which parts are there and what their events mean.
import type { ComponentChildren } from 'preact';
import { samples } from '../../samples/samples.ts';
import type { Sample } from '../../samples/samples.ts';
import type { Encoding } from '../../encoding.ts';
import type { OutputFormat, Quality } from '../../formats.ts';
import { t } from '../../messages/messages.ts';
import type { Language } from '../../messages/messages.ts';
import { fewestTriangles, isBusy, isOutputCurrent, isSettled, progress } from '../../state.ts';
import type { Model, Sheet as SheetName, State, View } from '../../state.ts';
import { statusText } from '../../status.ts';
import { Batch } from '../batch/batch.tsx';
import type { BatchActions } from '../batch/batch.tsx';
import { Compare } from '../compare/compare.tsx';
import { Details } from '../details/details.tsx';
import { Download } from '../download/download.tsx';
import { DropHint, Landing } from '../drop-zone/drop-zone.tsx';
import { FileChooser } from '../drop-zone/file-chooser.tsx';
import { Help } from '../help/help.tsx';
import { Icon } from '../icon/icon.tsx';
import { Legend } from '../legend/legend.tsx';
import { LodSlider } from '../lod-slider/lod-slider.tsx';
import { LanguageChoice } from '../language-choice/language-choice.tsx';
import { Logo } from '../logo/logo.tsx';
import { MeshStats } from '../mesh-stats/mesh-stats.tsx';
import { Notice } from '../notice/notice.tsx';
import { Options } from '../options/options.tsx';
import type { OptionsActions } from '../options/options.tsx';
import { Progress } from '../progress/progress.tsx';
import { Samples } from '../samples/samples.tsx';
import { Sheet } from '../sheet/sheet.tsx';
import { ThemeButton } from '../theme-button/theme-button.tsx';
import { Toolbar } from '../toolbar/toolbar.tsx';
import { UpdateOffer } from '../update-offer/update-offer.tsx';
import './app.css';

/** What the user can do; the wiring decides what it does. */
export interface Actions extends OptionsActions, BatchActions {
  openFiles(files: FileList): void;
  openSample(sample: Sample): void;
  cancel(): void;
  dismiss(): void;
  moveTarget(triangles: number, gesture: number): void;
  undo(): void;
  redo(): void;
  fit(): void;
  /** Takes up the brush, or puts it down. */
  paint(): void;
  changeView(change: Partial<View>): void;
  loadUpdate(): void;
  declineUpdate(): void;
  changeMorph(index: number, weight: number | null): void;
  chooseFormat(format: OutputFormat): void;
  chooseEncoding(encoding: Encoding): void;
  chooseQuality(quality: Quality): void;
  toggleSheet(sheet: SheetName | null): void;
  toggleHelp(shown: boolean): void;
  download(): void;
  measure(): void;
  watchArrival(): void;
  toggleArrival(): void;
  closeArrival(): void;
  chooseLanguage(language: Language): void;
}

interface AppProps {
  readonly state: State;
  readonly actions: Actions;
  /** What stands in the panel's place while the model arrives; loaded when that is asked for. */
  readonly arrival: ComponentChildren;
}

export function App({ state, actions, arrival }: AppProps) {
  const { model, notice, view } = state;
  const status = statusText(state);
  return (
    <>
      <header class="top-bar">
        <a class="brand" href="./" aria-label={t('start.home')}>
          <Logo />
          <span class="brand-name">decimesh</span>
        </a>
        {model !== null && <p class="model-name" title={model.credit || undefined}>{model.name}</p>}
        <div class="top-actions">
          {model !== null && <FileChooser id="file" label={t('start.open')} onFiles={actions.openFiles} />}
          {model !== null && <FileChooser id="folder" label={t('start.folder')} folder iconOnly onFiles={actions.openFiles} />}
          <LanguageChoice language={state.language} onLanguage={actions.chooseLanguage} />
          <button type="button" class="quiet icon-button" aria-label={t('panel.help')} title={`${t('panel.help')} (?)`} onClick={() => actions.toggleHelp(true)}>
            <Icon name="help" />
          </button>
          <ThemeButton theme={view.theme} onTheme={(theme) => actions.changeView({ theme })} />
        </div>
      </header>

      {state.batch !== null ? (
        <Batch batch={state.batch} quality={state.quality} actions={actions} />
      ) : model === null ? (
        <Landing onFiles={actions.openFiles}>
          <Samples samples={samples} onChoose={actions.openSample} />
        </Landing>
      ) : (
        <ModelPanel state={state} model={model} status={status} actions={actions} arrival={arrival} />
      )}

      <div class="messages">
        {state.updateOffered && <UpdateOffer onLoad={actions.loadUpdate} onLater={actions.declineUpdate} />}
        {notice !== null && <Notice notice={notice} onDismiss={actions.dismiss} />}
        {model === null && isBusy(state) && (
          <div class="panel busy-panel">
            <p>{status}</p>
            <Progress fraction={progress(state)} label={status} onCancel={actions.cancel} />
          </div>
        )}
      </div>
      {state.dragging && <DropHint />}
      {state.help && <Help onClose={() => actions.toggleHelp(false)} />}
      <p class={model === null ? 'visually-hidden' : 'status'} role="status">{status}</p>
    </>
  );
}

function ModelPanel({ state, model, status, actions, arrival }: AppProps & { readonly model: Model; readonly status: string }) {
  const settled = isSettled(model);
  const outputCurrent = isOutputCurrent(state);
  const sheets = { options: t('panel.options'), details: t('panel.details') };
  return (
    <main class={model.drawn ? 'workspace' : 'workspace waiting'}>
      <Compare
        layout={state.paint === null ? state.view.layout : 'single'}
        split={state.view.split}
        comparing={state.view.comparing}
        insets={state.insets}
        onSplit={(split) => actions.changeView({ split })}
      />
      <Legend
        surface={state.view.surface}
        edgeCounts={state.edgeCounts}
        measurement={model.measurement}
        diagonal={model.source.diagonal}
      />
      <Toolbar
        view={state.view}
        contents={state.contents}
        insets={state.insets}
        reducedMotion={state.reducedMotion}
        animations={model.animations}
        canUndo={model.undo.length > 0 && state.arrival === null}
        canRedo={model.redo.length > 0 && state.arrival === null}
        painting={state.paint !== null}
        fetchingBrush={state.fetchingBrush}
        onFit={actions.fit}
        onPaint={actions.paint}
        onView={actions.changeView}
        onMorph={actions.changeMorph}
        onUndo={actions.undo}
        onRedo={actions.redo}
      />
      {state.sheet !== null && (
        <Sheet key={state.sheet} title={sheets[state.sheet]} bottom={state.insets.bottom} onClose={() => actions.toggleSheet(null)}>
          {state.sheet === 'options' ? <Options state={state} model={model} actions={actions} /> : <Details model={model} outputCurrent={outputCurrent} onArrival={actions.watchArrival} />}
        </Sheet>
      )}
      <div class="dock" data-inset>
        {model.credit !== '' && <p class="credit">{model.credit}</p>}
        {state.arrival !== null ? arrival : (
        <section class="panel model-panel" aria-label={t('panel.name')}>
          {isBusy(state) && <Progress fraction={progress(state)} label={status} onCancel={actions.cancel} />}
          <LodSlider
            value={model.wantedTriangles}
            fewest={fewestTriangles(model)}
            all={model.source.triangles}
            pending={!settled}
            onChange={actions.moveTarget}
          >
            {(['details', 'options'] as const).map((sheet) => (
              <button
                key={sheet}
                type="button"
                class="quiet sheet-button"
                aria-expanded={state.sheet === sheet}
                title={`${sheets[sheet]} (${sheet === 'options' ? 'O' : 'I'})`}
                onClick={() => actions.toggleSheet(sheet)}
              >
                <Icon name={sheet === 'options' ? 'sliders' : 'details'} />
                <span>{sheets[sheet]}</span>
                {sheet === 'details' && model.warnings.length > 0 && <span class="badge" title={t('remarks.title', { count: model.warnings.length })}>{model.warnings.length}</span>}
              </button>
            ))}
          </LodSlider>
          <div class="panel-foot">
            <MeshStats
              model={model}
              pending={!settled}
              outputCurrent={outputCurrent}
              onMeasure={actions.measure}
              onCancel={actions.cancel}
            />
            <Download
              format={state.outputFormat}
              encoding={state.encoding}
              quality={state.quality}
              busy={state.task?.kind === 'writing' || state.task?.kind === 'fitting'}
              onFormat={actions.chooseFormat}
              onEncoding={actions.chooseEncoding}
              onQuality={actions.chooseQuality}
              onDownload={actions.download}
            />
          </div>
        </section>
        )}
      </div>
    </main>
  );
}
