// How many pixels a moving picture has: fewer where frames come late and fewer help, all of them where it stands.

const slow = 1000 / 45, fast = 1000 / 57; // mean times of a frame [ms] that ask for fewer pixels, and allow more
const looked_at = 12; // frames that a mean is of; the first after a change tells of the change alone
const steps = [1, 0.75, 0.55, 0.4];

export class Pace {
  // finest: pixels of the picture to a pixel of the page
  constructor(finest) {
    Object.assign(this, { finest, step: 0, playing: false, count: -1, sum: 0, tried: null, good: 0, vain: 0, patience: 10 });
  }
  get ratio() { return this.finest * (this.playing ? steps[this.step] : 1); }

  // A frame that took so long [ms]; true where the ratio is another now.
  frame(milliseconds) {
    const before = this.ratio;
    this.playing = true;
    // A page that was hidden, or a machine that was asleep, says nothing of pictures.
    if (milliseconds < 1000 && ++this.count > 0) this.sum += milliseconds;
    if (this.count === looked_at) {
      this.judge(this.sum / looked_at);
      this.begin();
    }
    return this.ratio !== before;
  }
  judge(mean) {
    this.good = mean < fast ? this.good + 1 : 0;
    const vain = this.tried != null && mean > 0.9 * this.tried;
    this.tried = null;
    if (vain) {
      // The time goes elsewhere: into the page, or to other programs.
      --this.step;
      this.vain = this.patience;
    } else if (mean > slow && this.step < steps.length - 1 && --this.vain < 0) {
      this.tried = mean;
      ++this.step;
    } else if (this.step > 0 && this.good >= this.patience) {
      --this.step;
      this.good = 0;
      this.patience *= 2; // what was too much is not tried again and again
    }
  }
  rest() {
    this.playing = false;
    this.tried = null;
    this.begin();
  }
  begin() {
    this.count = -1;
    this.sum = 0;
  }
}
