"""python -m stormfield"""

from .cli import run

if __name__ == "__main__":
    run()
