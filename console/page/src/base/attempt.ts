// Steps whose errors a view reports.
import { explain, type Explained } from "./api";

type Report = (error: Explained | undefined) => void;

// Reports the error of `action`. `title`: of an error that the page itself made, such as of a file that cannot be read.
export async function attempt(report: Report, action: () => Promise<void>, title = ""): Promise<void> {
  try {
    await action();
  } catch (error) {
    report(explain(error, title));
  }
}
