import type { Catalogue } from '../src/engine/definitions';
import { golden } from './golden';

/** What the package tells the engine, as stored by `golden/make.py`. */
export const CATALOGUE = golden<Catalogue>('catalogue.json');
