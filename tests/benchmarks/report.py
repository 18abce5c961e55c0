"""The report: tables in Markdown on standard output and in a file, and a plot beside it."""


class Report:
    def __init__(self, folder):
        folder.mkdir(parents=True, exist_ok=True)
        self.folder = folder
        self.file = open(folder / "report.md", "w")

    def sentence(self, text):
        for target in (None, self.file):
            print(text, end="\n\n", file=target, flush=True)

    def table(self, title, what, head, rows):
        """Rows may be shorter than the head: the rest was not to be measured."""
        filled = [[str(cell) for cell in row] + [""] * (len(head) - len(row)) for row in rows]
        lines = [head, ["---"] * len(head), *filled]
        table = "\n".join("| " + " | ".join(line) + " |" for line in lines)
        self.sentence(f"## {title}\n\n{what}\n\n{table}")

    def plot(self, seconds):
        """Seconds over triangles, a line for each name."""
        try:
            import matplotlib
        except ImportError:
            self.sentence("No plot: Matplotlib (python3-matplotlib) is missing.")
            return
        matplotlib.use("svg")
        from matplotlib import pyplot

        figure, axes = pyplot.subplots(figsize=(7, 4.5))
        for name, points in seconds.items():
            own = name.startswith("Signorini")
            axes.loglog(*zip(*points), marker="o", linestyle="-" if own else "--", label=name)
        axes.set(xlabel="triangles", ylabel="seconds, whole process, one core")
        axes.grid(True, which="both", alpha=0.3)
        axes.legend()
        figure.savefig(self.folder / "seconds.svg", bbox_inches="tight")

    def close(self):
        self.file.close()
        print(f"Written: {self.folder}/report.md, {self.folder}/seconds.svg")
