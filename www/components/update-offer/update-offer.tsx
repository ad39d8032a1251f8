// Offers a new version of the page; nothing happens until it is taken.
import { t } from '../../messages/messages.ts';
import './update-offer.css';

interface UpdateOfferProps {
  onLoad(): void;
  onLater(): void;
}

export function UpdateOffer({ onLoad, onLater }: UpdateOfferProps) {
  return (
    <section class="panel update-offer" aria-label={t('app.update')}>
      <p>
        {t('app.update')} <span class="hint">{t('app.updateHint')}</span>
      </p>
      <button type="button" class="primary" onClick={onLoad}>{t('app.updateNow')}</button>
      <button type="button" class="quiet" onClick={onLater}>{t('app.updateLater')}</button>
    </section>
  );
}
